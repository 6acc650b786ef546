// OBJ and MTL texts looked through line by line: tinyobjloader reads numbers without complaint and tells no lines.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray {

/// Lines that begin with a keyword, in order; tinyobjloader calls back in the same order.
struct ObjLines {
  std::vector<int> faces, uses, libraries;
};

/// Complaints, at most 20, go to `diagnostics`: numbers that are none, corners that are no whole numbers, zero bytes.
ObjLines check_obj(const std::string &file, const std::string &text, std::vector<Diagnostic> &diagnostics);

/// The line of each material. Reflectances from 0 to 1, emission of 0 or more, n from 1 to 10, transparency from 0
/// to 1.
std::map<std::string, int> check_mtl(const std::string &file, const std::string &text,
                                     std::vector<Diagnostic> &diagnostics);

}  // namespace greenray
