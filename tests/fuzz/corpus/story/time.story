start a
wait ready within infs
