# Lists the files of live/page/web/ and makes web_files.cpp, which holds them. Sets
# page_web_files, the source, and page_web_inputs, what it is made of.
set(web ${CMAKE_CURRENT_SOURCE_DIR}/page/web)
set(names index.html page.css canvas.js main.js connection.js controls.js format.js picture.js plots.js
  scene.js sensors.js words.js)
set(type_html "text/html")
set(type_css "text/css")
set(type_js "text/javascript")
set(embedded "")
set(served "")
set(page_web_inputs "")
foreach(name IN LISTS names)
  string(MAKE_C_IDENTIFIER "flextip_web_${name}" symbol)
  string(REGEX REPLACE ".*\\." "" ending ${name})
  string(APPEND embedded "asm(\".section .rodata\\n.global ${symbol}_begin\\n${symbol}_begin:\\n\"
    \".incbin \\\"${web}/${name}\\\"\\n.global ${symbol}_end\\n${symbol}_end:\\n.byte 0\\n.previous\\n\");
extern \"C\" const char ${symbol}_begin[];
extern \"C\" const char ${symbol}_end[];
")
  string(APPEND served "      ServedFile{\"/${name}\", \"${type_${ending}}; charset=utf-8\",
                 {${symbol}_begin, static_cast<std::size_t>(${symbol}_end - ${symbol}_begin)}},
")
  list(APPEND page_web_inputs ${web}/${name})
endforeach()
set(page_web_files ${CMAKE_CURRENT_BINARY_DIR}/web_files.cpp)
configure_file(${CMAKE_CURRENT_SOURCE_DIR}/page/web_files.cpp.in ${page_web_files} @ONLY)
set_source_files_properties(${page_web_files} PROPERTIES OBJECT_DEPENDS "${page_web_inputs}"
  SKIP_UNITY_BUILD_INCLUSION ON)
