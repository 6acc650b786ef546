# Writes OUTPUT, a C++ file with every file of LIST (paths relative to ROOT) as a string, for host/support/embedded.hpp.
#   cmake -DROOT=... -DLIST=file -DOUTPUT=out.cpp -P embed.cmake        LIST names a file with one path a line
file(STRINGS "${LIST}" paths)
set(text "#include \"support/embedded.hpp\"\n#include <algorithm>\n#include <array>\n#include <utility>\nnamespace greenray {\nusing Entry = std::pair<std::string_view, std::string_view>;\n")
set(table "")
set(count 0)
foreach(path IN LISTS paths)
  file(READ "${ROOT}/${path}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  # '\xNN' above 0x7f needs no cast: plain char constants of one hex escape are char.
  string(APPEND text "static const char file_${count}[] = {${bytes}'\\0'};\n")
  string(APPEND table "  Entry{\"${path}\", std::string_view(file_${count}, sizeof file_${count} - 1)},\n")
  math(EXPR count "${count} + 1")
endforeach()
string(APPEND text "static const std::array<Entry, ${count}> files{{\n${table}}};\n")
string(APPEND text "std::optional<std::string_view> embedded_file(std::string_view path) {\n  for (const Entry &e : files)\n    if (e.first == path) return e.second;\n  return std::nullopt;\n}\nstd::vector<std::string> embedded_files(std::string_view folder) {\n  std::vector<std::string> names;\n  for (const Entry &e : files)\n    if (e.first.substr(0, folder.size()) == folder) names.emplace_back(e.first);\n  std::sort(names.begin(), names.end());\n  return names;\n}\n}  // namespace greenray\n")
file(WRITE "${OUTPUT}.new" "${text}")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}" ONLY_IF_DIFFERENT)
file(REMOVE "${OUTPUT}.new")
