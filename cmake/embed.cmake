# SPDX-License-Identifier: Apache-2.0
# cmake -DOUT=x.cpp -DFILES="a;b" -DFUNCTION=space::name [-DPREFIX=/] -P embed.cmake: writes
# std::map<std::string, std::string_view> space::name(): the files' names after PREFIX, and their bytes.
string(REGEX REPLACE "^(.*)::([^:]*)$" "\\1" namespace "${FUNCTION}")
string(REGEX REPLACE "^(.*)::([^:]*)$" "\\2" function "${FUNCTION}")
set(arrays "")
set(rows "")
set(number 0)
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  file(READ ${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "const unsigned char file_${number}[] = {${bytes}0};\n")
  string(APPEND rows "      {\"${PREFIX}${name}\", std::string_view(reinterpret_cast<const char*>(file_${number}), sizeof file_${number} - 1)},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT}.new "#include <map>\n#include <string>\n#include <string_view>\n\nnamespace ${namespace} {\nnamespace {\n${arrays}}  // namespace\n

std::map<std::string, std::string_view> ${function}() {\n  return {\n${rows}  };\n}\n}  // namespace ${namespace}\n")
file(RENAME ${OUT}.new ${OUT})
