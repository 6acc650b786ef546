#include <set>
#include <sstream>

#include "bench/record.hpp"

namespace greenray::bench {
namespace {

std::string quoted(const std::string &text) {
  if (text.find_first_of(",\"\n\r#") == std::string::npos) return text;
  std::string safe = "\"";
  for (const char c : text) safe += c == '"' ? "\"\"" : std::string(1, c);
  return safe + "\"";
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

}  // namespace

std::string as_csv(const Results &results) {
  std::set<std::string> more;
  for (const Record &r : results.records)
    for (const auto &[name, value] : r.more) more.insert(name);
  std::ostringstream csv;
  csv << "# " << results.summary << "\n";
  for (const auto &[name, value] : results.about) csv << "# " << name << ": " << value << "\n";
  csv << "suite,case,variant,device,by,by_version,solver,precision,lanes,rate,rate_unit,error,error_unit,cpu_seconds,"
         "wall_seconds,median_rate,repeats,peer,peer_version,peer_variant,peer_rate,peer_error,ratio,cpu_ratio";
  for (const std::string &name : more) csv << "," << name;
  csv << "\n";
  for (const Record &r : results.records) {
    for (const std::string &text :
         {r.suite, r.case_name, r.variant, r.device, r.kind.by, r.kind.version, r.kind.solver, r.kind.precision})
      csv << quoted(text) << ",";
    csv << r.kind.lanes << "," << number(r.rate) << "," << quoted(r.rate_unit) << "," << number(r.error) << ","
        << quoted(r.error_unit) << "," << number(r.cpu_seconds) << "," << number(r.wall_seconds) << ","
        << number(r.median_rate) << "," << r.repeats << ",";
    if (r.peer)
      csv << quoted(r.peer->name) << "," << quoted(r.peer->version) << "," << quoted(r.peer->variant) << ","
          << number(r.peer->rate) << "," << number(r.peer->error) << "," << number(r.peer->ratio) << ","
          << number(r.peer->cpu_ratio);
    else csv << ",,,,,,";
    for (const std::string &name : more) csv << "," << (r.more.count(name) ? number(r.more.at(name)) : "");
    csv << "\n";
  }
  return csv.str();
}

}  // namespace greenray::bench
