# Writes `headers` of `source` into the folder `include`, with their includes as <flextip/...>.
foreach(header IN LISTS headers)
  file(READ ${source}/${header} text)
  string(REGEX REPLACE "#include \"([a-z_]+/[^\"\n]+)\"" "#include <flextip/\\1>" text "${text}")
  file(WRITE ${include}/${header} "${text}")
endforeach()
