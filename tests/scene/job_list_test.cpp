// Lists of pictures, and the pictures of sweeps.
#include <gtest/gtest.h>

#include "scene/job_list.hpp"
#include "scene/sweeps.hpp"

namespace greenray {
namespace {

// oracle: the text itself, read by eye.  tolerance: none
TEST(JobList, ReadsCsv) {
  const auto jobs = parse_jobs("some/list.csv",
                               "# two pictures\n\nscene, name ,observer.resolution,title\n"
                               "green-flash,a,\"[40, 30]\",\"said \"\"so\"\"\"\r\nsmoke,,,\n");
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].scene, "green-flash");
  EXPECT_EQ(jobs[0].name, "a");
  EXPECT_EQ(jobs[0].overrides, (std::vector<std::string>{"observer.resolution=[40, 30]", "title=said \"so\""}));
  EXPECT_EQ(jobs[0].place.line, 4);
  EXPECT_EQ(jobs[1].name, "list-0002");
  EXPECT_TRUE(jobs[1].overrides.empty());
}

// oracle: the text itself, read by eye.  tolerance: none
TEST(JobList, ReadsToml) {
  const std::string text =
      "[[job]]\nscene = \"smoke\"\nsun.altitude_deg = -0.5\n\n[[job]]\nscene = \"cornell\"\nname = \"b\"\n"
      "light.0.power_W = 3\n";
  EXPECT_TRUE(is_job_list("l.toml", text));
  EXPECT_FALSE(is_job_list("l.toml", "greenray = 1\n"));
  EXPECT_FALSE(is_job_list("l.toml", "no TOML"));
  const auto jobs = parse_jobs("l.toml", text);
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].overrides, (std::vector<std::string>{"sun.altitude_deg=-0.5"}));
  EXPECT_EQ(jobs[1].name, "b");
  EXPECT_EQ(jobs[1].overrides, (std::vector<std::string>{"light.0.power_W=3"}));
  EXPECT_EQ(jobs[1].place.line, 5);
  EXPECT_THROW(parse_jobs("l.toml", "[[job]]\nname = \"b\"\n"), InputError);
  EXPECT_THROW(parse_jobs("l.toml", text + "[other]\nx = 1\n"), InputError);
}

// oracle: counted by hand.  tolerance: none
TEST(Sweeps, EveryValueWithEveryOther) {
  SweepScene a, b;
  a.key = "x", a.values = {1, 2.5};
  b.key = "y", b.values = {-3, 4, 5};
  const auto pictures = pictures_of({a, b});
  ASSERT_EQ(pictures.size(), 6U);
  EXPECT_EQ(pictures[0], (std::vector<std::string>{"x=1", "y=-3"}));
  EXPECT_EQ(pictures[1], (std::vector<std::string>{"x=1", "y=4"}));
  EXPECT_EQ(pictures[5], (std::vector<std::string>{"x=2.5", "y=5"}));
  b.values.assign(600000, 1.0);
  EXPECT_THROW(pictures_of({a, b}), InputError);
}

// oracle: file names must sort as the pictures do.  tolerance: none
TEST(JobList, NumbersSort) {
  EXPECT_EQ(numbered_name("s", 0, 61), "s-0001");
  EXPECT_EQ(numbered_name("s", 9999, 10000), "s-10000");
  EXPECT_EQ(numbered_name("s", 8, 10000), "s-00009");
}

}  // namespace
}  // namespace greenray
