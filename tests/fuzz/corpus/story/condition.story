start a
expect joy within 1s
