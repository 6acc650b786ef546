// A list of pictures to make: rows of a CSV or TOML file whose columns are scene keys.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "support/error.hpp"

namespace greenray {

struct Job {
  std::string scene;                   // a file, or the name of one that ships
  std::string name;                    // of the picture's files
  std::vector<std::string> overrides;  // "KEY=VALUE"
  SourcePlace place;                   // of its row
};

/// Is this a list of jobs rather than a scene? `.csv`, or TOML with [[job]].
bool is_job_list(const std::string &file, std::string_view text);

/* CSV: `#` comments, a header, then a row a picture; cells with a comma stand in double quotes, empty cells change
   nothing. TOML: [[job]] rows. Column `scene` says what to render, `name` (optional) what the files are called, every
   other column is a scene key, such as sun.altitude_deg; its cells are TOML values.
   errors: InputError with every complaint: no `scene`, rows of another length, a name twice or with a slash. */
std::vector<Job> parse_jobs(const std::string &file, std::string_view text);

/// NAME-0001 .. with as many digits as the count needs, four at least; file names sort as the pictures do.
std::string numbered_name(const std::string &name, std::size_t index, std::size_t count);

}  // namespace greenray
