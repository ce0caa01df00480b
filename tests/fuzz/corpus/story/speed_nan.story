start a
speed nan
