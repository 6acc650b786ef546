#include "bench/record.hpp"

#include <cmath>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "support/error.hpp"

namespace greenray::bench {
namespace {

using Json = nlohmann::json;
constexpr const char *format = "greenray-bench 1";

/// Four digits with k, M for large rates.
std::string short_rate(double rate) {
  std::ostringstream text;
  text << std::setprecision(3);
  if (rate >= 1e6) text << rate / 1e6 << " M";
  else if (rate >= 1e3) text << rate / 1e3 << " k";
  else text << rate << " ";
  return text.str();
}

Json json_of(const Record &r) {
  const auto or_null = [&](auto member) { return r.peer ? Json((*r.peer).*member) : Json(); };
  Json out{{"suite", r.suite},
           {"case", r.case_name},
           {"variant", r.variant},
           {"device", r.device},
           {"by", r.kind.by},
           {"by_version", r.kind.version},
           {"solver", r.kind.solver},
           {"precision", r.kind.precision},
           {"lanes", r.kind.lanes},
           {"rate", r.rate},
           {"rate_unit", r.rate_unit},
           {"error", r.error},
           {"error_unit", r.error_unit},
           {"cpu_seconds", r.cpu_seconds},
           {"wall_seconds", r.wall_seconds},
           {"peer", or_null(&PeerPoint::name)},
           {"peer_version", or_null(&PeerPoint::version)},
           {"peer_rate", or_null(&PeerPoint::rate)},
           {"peer_error", or_null(&PeerPoint::error)},
           {"ratio", or_null(&PeerPoint::ratio)},
           {"peer_variant", or_null(&PeerPoint::variant)},
           {"cpu_ratio", or_null(&PeerPoint::cpu_ratio)},
           {"median_rate", r.median_rate},
           {"repeats", r.repeats}};
  for (const auto &[name, value] : r.more) out[name] = value;
  return out;
}

/// Keys with a place of their own in Record; every other number goes to `more`.
const std::set<std::string> own_keys{"rate",  "error",     "cpu_seconds", "wall_seconds", "peer_rate", "peer_error",
                                     "ratio", "cpu_ratio", "median_rate", "repeats",      "lanes"};

Record record_from(const Json &in) {
  Record r;
  r.kind = {in.value("by", std::string()), in.value("by_version", std::string()), in.value("solver", std::string()),
            in.value("precision", std::string()), in.value("lanes", 1)};
  for (const auto &[name, value] : in.items())
    if (value.is_number() && !own_keys.count(name)) r.more[name] = value.get<double>();
  r.suite = in.at("suite").get<std::string>();
  r.case_name = in.at("case").get<std::string>();
  r.variant = in.at("variant").get<std::string>();
  r.device = in.at("device").get<std::string>();
  r.rate = in.at("rate").get<double>();
  r.rate_unit = in.at("rate_unit").get<std::string>();
  r.error = in.at("error").get<double>();
  r.error_unit = in.at("error_unit").get<std::string>();
  r.cpu_seconds = in.at("cpu_seconds").get<double>();
  r.wall_seconds = in.at("wall_seconds").get<double>();
  r.median_rate = in.value("median_rate", r.rate);
  r.repeats = in.value("repeats", 1);
  if (in.at("peer").is_string())
    r.peer = PeerPoint{in.at("peer").get<std::string>(),
                       in.at("peer_version").get<std::string>(),
                       in.value("peer_variant", std::string()),
                       in.at("peer_rate").get<double>(),
                       in.at("peer_error").get<double>(),
                       in.at("ratio").get<double>(),
                       in.value("cpu_ratio", 0.0)};
  return r;
}

}  // namespace

std::string as_json(const Results &results) {
  Json out{
      {"format", format}, {"summary", results.summary}, {"contended", results.contended}, {"about", results.about}};
  out["records"] = Json::array();
  for (const Record &r : results.records) out["records"].push_back(json_of(r));
  return out.dump(1) + "\n";
}

Results read_results(const std::filesystem::path &path) {
  std::ifstream file(path);
  if (!file)
    throw InputError({path.string(), 1, 1}, "cannot be read: expected a file written by `greenray bench --json`");
  try {
    const Json in = Json::parse(file);
    if (in.at("format") != format)
      throw InputError({path.string(), 1, 1}, std::string("expected \"format\": \"") + format + "\"");
    Results results;
    results.summary = in.value("summary", std::string());
    results.contended = in.value("contended", false);
    results.about = in.value("about", std::map<std::string, std::string>());
    for (const Json &record : in.at("records")) results.records.push_back(record_from(record));
    return results;
  } catch (const Json::exception &error) {
    throw InputError({path.string(), 1, 1},
                     std::string("expected a file written by `greenray bench --json`: ") + error.what());
  }
}

std::string line_of(const Record &r) {
  std::ostringstream text;
  text << std::left << std::setw(15) << r.case_name << std::setw(58) << r.variant << std::right << std::setw(8)
       << short_rate(r.rate) << r.rate_unit << "  error " << std::setprecision(3) << r.error << " " << r.error_unit;
  if (r.peer)
    text << "  " << std::setprecision(3) << r.peer->ratio << " x (CPU " << r.peer->cpu_ratio << " x) " << r.peer->name
         << " at " << r.peer->error << " " << r.error_unit;
  text << "  +-" << std::setprecision(2) << 100 * r.spread() << " %";
  return text.str();
}

}  // namespace greenray::bench
