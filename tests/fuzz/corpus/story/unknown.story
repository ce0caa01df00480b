start a
dance
