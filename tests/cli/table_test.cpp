// Commands that print: headers, row order, JSON, help.
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

namespace greenray::cli_tests {

using Json = nlohmann::json;

class Tables : public ToolTest {
 protected:
  /// Header and rows of CSV output; comments must stand before the header.
  std::vector<std::string> rows(const Words &words) const {
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 0) << result.err;
    std::vector<std::string> rows;
    for (const std::string &line : lines_of(result.out)) {
      if (!line.starts_with('#')) rows.push_back(line);
      else EXPECT_TRUE(rows.empty()) << "comment after the header";
    }
    EXPECT_FALSE(rows.empty());
    return rows;
  }
  static void expect_begin(const std::vector<std::string> &rows, std::size_t i, const std::string &text) {
    ASSERT_LT(i, rows.size());
    EXPECT_TRUE(rows[i].starts_with(text)) << rows[i] << " should begin with " << text;
  }
};

// oracle: the contract's header, and altitudes outermost in the order given.  tolerance: none
TEST_F(Tables, RefractionHeaderAndOrder) {
  const auto table =
      rows({"refraction", "us76", "--height", "2", "--altitudes", "5,-1,0,0.5,1", "--wavelengths", "650,450"});
  ASSERT_EQ(table.size(), 11U);
  EXPECT_EQ(table[0],
            "apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,true_altitude_deg,air_mass,min_height_m,"
            "max_height_m,ground_distance_m,turning_points");
  const char *const begin[] = {"5,650,space,", "5,450,space,",  "-1,650,ground,", "-1,450,ground,", "0,650,space,",
                               "0,450,space,", "0.5,650,space", "0.5,450,space",  "1,650,space,",   "1,450,space,"};
  for (std::size_t i = 0; i < 10; ++i) expect_begin(table, i + 1, begin[i]);
}

// oracle: the contract: --threads takes part of a CPU device, and the bits do not depend on it; every method, both
//         precisions (PoCL aborted here when an image was written through a sub-device).  tolerance: none
TEST_F(Tables, FewerThreadsSameBits) {
  for (const std::string precision : {"float", "double"})
    for (const std::string method : {"cells", "rk", "richardson"}) {
      const Words words{"refraction", "us76",          "--height",    "2",           "--altitudes",
                        "0:2:0.0002", "--wavelengths", "550",         "--precision", precision,
                        "--method",   method,          "--tolerance", "0.01"};
      Words one = words;
      one.insert(one.end(), {"--threads", "1"});
      const Outcome all = run(words), part = run(one);
      EXPECT_EQ(part.code, 0) << method << " " << part.err;
      EXPECT_TRUE(all.out == part.out) << method << " " << precision;
    }
}

// oracle: numerics.md, section 4: 1982.156" at the horizon, 550 nm.  tolerance: half of the last digit given
TEST_F(Tables, RefractionJsonAndFile) {
  const Words words{"refraction", "us76", "--height", "0", "--altitudes", "0", "--wavelengths", "550"};
  Words json = words, file = words;
  json.push_back("--json");
  file.insert(file.end(), {"-o", "new/r.csv"});
  const Json row = Json::parse(run(json).out).at("rows").at(0);
  EXPECT_NEAR(row.at("refraction_arcsec").get<double>(), 1982.156, 5e-4);
  EXPECT_EQ(row.at("status"), "space");
  EXPECT_EQ(run(file).out, "");
  EXPECT_EQ(contents(folder / "new/r.csv"), run(words).out);
}

// oracle: the contract's header; distances innermost.  tolerance: none
TEST_F(Tables, TraceHeaderAndOrder) {
  const auto table = rows({"trace", "us76", "--height", "10", "--altitudes", "0,-1", "--wavelengths", "550,650",
                           "--distances", "0,100", "--plot", "new/rays.svg"});
  ASSERT_EQ(table.size(), 9U);
  EXPECT_EQ(
      table[0],
      "apparent_altitude_deg,wavelength_nm,distance_m,status,height_m,elevation_deg,bending_arcsec,optical_path_m");
  const char *const begin[] = {"0,550,0,in-flight,",   "0,550,100,in-flight,",    "0,650,0,in-flight,",
                               "0,650,100,in-flight,", "-1,550,0,in-flight,",     "-1,550,100,in-flight,8.2",
                               "-1,650,0,in-flight,",  "-1,650,100,in-flight,8.2"};
  for (std::size_t i = 0; i < 8; ++i) expect_begin(table, i + 1, begin[i]);
  EXPECT_NE(contents(folder / "new/rays.svg").find("<svg"), std::string::npos);
  const Json json = Json::parse(
      run({"trace", "us76", "--height=10", "--altitudes=-1", "--wavelengths=550", "--distances=1000", "--json"}).out);
  EXPECT_EQ(json.at("rows").at(0).at("status"), "ground");
}

// oracle: the contract's header; T0 and P0 of the 1976 standard.  tolerance: none, given values
TEST_F(Tables, ProfileHeaderAndOrder) {
  const auto table = rows({"profile", "us76", "--heights", "11000,0", "--wavelengths", "550,450"});
  ASSERT_EQ(table.size(), 5U);
  EXPECT_EQ(table[0],
            "height_m,temperature_K,pressure_Pa,density_kg_m3,wavelength_nm,refractivity,refractivity_gradient_per_m");
  expect_begin(table, 1, "11000,");
  expect_begin(table, 3, "0,288.15,1013");
  EXPECT_NE(table[3].find(",550,"), std::string::npos);
  EXPECT_NE(table[4].find(",450,"), std::string::npos);
  const Json json = Json::parse(run({"profile", "us76", "--heights=0", "--wavelengths=550", "--json"}).out);
  EXPECT_EQ(json.at("rows").at(0).at("temperature_K"), 288.15);
}

// oracle: what was imported, read again.  tolerance: none, the same text
TEST_F(Tables, ProfileWrittenIsTheSameAir) {
  const std::string sounding = std::string(GREENRAY_TEST_DATA) + "/soundings/wyoming_list_synthetic.txt";
  const Words lists{"--heights", "0,30,500,20000", "--wavelengths", "550"};
  Words first{"profile", sounding, "-o", "new/air.toml", "--plot", "new/air.svg"}, second{"profile", "new/air.toml"};
  first.insert(first.end(), lists.begin(), lists.end());
  second.insert(second.end(), lists.begin(), lists.end());
  const auto imported = rows(first);
  EXPECT_EQ(imported, rows(second));
  EXPECT_EQ(listing(folder / "new").size(), 2U);
}

// oracle: known-answer kernels on the device that is here.  tolerance: none
TEST_F(Tables, Devices) {
  const Outcome list = run({"devices"});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_TRUE(list.out.starts_with("0:0  ")) << list.out;
  const Outcome test = run({"devices", "--test", "--json", "--device", "pocl"});
  ASSERT_EQ(test.code, 0) << test.out << test.err;
  for (const Json &device : Json::parse(test.out)) {
    EXPECT_GE(device.at("tests").size(), 3U);
    for (const Json &one : device.at("tests")) EXPECT_TRUE(one.at("passed").get<bool>()) << one.dump();
  }
}

// oracle: each command tells its flags.  tolerance: none
TEST_F(Tables, Help) {
  const std::string all = run({"--help"}).out;
  EXPECT_EQ(run({}).out, all);
  for (const char *name :
       {"render", "check", "scenes", "new", "profile", "refraction", "trace", "develop", "compare", "devices"}) {
    EXPECT_NE(all.find(std::string("greenray ") + name), std::string::npos) << name;
    const Outcome help = run({name, "--help"});
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_NE(help.out.find("--device"), std::string::npos) << name;
    EXPECT_EQ(run({"help", name}).out, help.out);
  }
  EXPECT_TRUE(run({"--version"}).out.starts_with("greenray "));
}

// oracle: the inferior mirage (G04 figure 5.1): over a hot road a low point is seen twice, the lower image upside down;
// and
//         `refraction` by steps at each image leads back to the true altitude.  tolerance: 0.02", the curve's 0.01" and
//         steps'
TEST_F(Tables, ImagesFromATransferFile) {
  const Outcome written = run({"transfer", "hot-road", "--height", "1.5", "--wavelengths", "550", "--from", "-0.4",
                               "--to", "0.4", "-o", "curve.csv"});
  ASSERT_EQ(written.code, 0) << written.err;
  const Json images = Json::parse(run({"transfer", "--table", "curve.csv", "--images", "-0.5,-0.7", "--json"}).out);
  const Json &seen = images.at("rows").at(0).at("images");
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].at("orientation"), "inverted");
  EXPECT_EQ(seen[1].at("orientation"), "erect");
  EXPECT_TRUE(images.at("rows").at(1).at("images").empty());
  for (const Json &image : seen) {
    const std::string altitude = std::to_string(image.at("apparent_altitude_deg").get<double>());
    const Json traced = Json::parse(run({"refraction", "hot-road", "--height", "1.5", "--altitudes", altitude,
                                         "--wavelengths", "550", "--method", "rk", "--json"})
                                        .out);
    const double slope = std::max(1.0, 1 / image.at("magnification").get<double>());
    const double rounded = 5e-7 * 3600;  // of `altitude`, to six decimals
    EXPECT_NEAR(3600 * traced.at("rows").at(0).at("true_altitude_deg").get<double>(), 3600 * -0.5,
                (0.02 + rounded) * slope);
  }
}

// oracle: the flags' own descriptions: a profile or a table, never both, and nothing that does not belong.
TEST_F(Tables, TransferRefusesHalfRequests) {
  for (const Words &words :
       {Words{"transfer"}, Words{"transfer", "us76", "--height", "2"},
        Words{"transfer", "us76", "--wavelengths", "550"},
        Words{"transfer", "us76", "--table", "x.csv", "--images", "0"}, Words{"transfer", "--table", "x.csv"},
        Words{"transfer", "--table", "x.csv", "--images", "0"},
        Words{"transfer", "--table", "x.csv", "--images", "0", "--height", "2"},
        Words{"transfer", "us76", "--height", "2", "--wavelengths", "550", "--from", "2", "--to", "1"}}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_TRUE(result.out.empty());
    EXPECT_EQ(lines_of(result.err).size(), 1U) << result.err;
  }
}

}  // namespace greenray::cli_tests
