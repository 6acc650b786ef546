// Workers that make one picture together: threads with a device each, as --device all has them; mpirun's processes go
// the same way through Ranks.
#include <atomic>
#include <thread>

#include "trust/rooms.hpp"

namespace greenray {
namespace {

TEST(Ranks, EveryoneGetsItsOwnLetters) {
  // oracle: the letters themselves;  tolerance: none
  run_threads(4, [](Ranks &ranks) {
    for (int turn = 0; turn < 50; ++turn) {
      std::vector<std::string> out;
      for (int r = 0; r < 4; ++r)
        out.push_back(std::string(static_cast<std::size_t>(turn), 'x') + std::to_string(10 * ranks.rank() + r));
      const std::vector<std::string> in = ranks.exchange(out);
      for (int r = 0; r < 4; ++r)
        ASSERT_EQ(in[static_cast<std::size_t>(r)],
                  std::string(static_cast<std::size_t>(turn), 'x') + std::to_string(10 * r + ranks.rank()));
    }
    EXPECT_EQ(ranks.from_first(ranks.first() ? "words" : "others"), "words");
    EXPECT_EQ(ranks.at_first("mine").size(), ranks.first() ? 4U : 0U);
  });
}

TEST(Ranks, AFailureFreesTheOthersAndIsTold) {
  // oracle: the exception of the one that failed, in a time that is no wait;  tolerance: none
  std::atomic<int> freed{0};
  const auto run = [&](int which) {
    run_threads(3, [&](Ranks &ranks) {
      if (ranks.rank() == which) throw MemoryError("no room");
      try {
        (void)ranks.exchange(std::vector<std::string>(3));
      } catch (const RanksLost &) {
        ++freed;
        throw;
      }
    });
  };
  for (int which = 0; which < 3; ++which) EXPECT_THROW(run(which), MemoryError);
  EXPECT_EQ(freed, 6);
  const auto together = [](int which) {
    run_threads(3, [&](Ranks &ranks) {
      ranks.together([&] {
        if (ranks.rank() == which) throw MemoryError("no room");
      });
    });
  };
  for (int which = 0; which < 3; ++which) {
    try {
      together(which);
      ADD_FAILURE() << "no error";
    } catch (const Error &error) {
      EXPECT_EQ(error.exit_code(), ExitCode::out_of_memory);
      EXPECT_NE(std::string(error.what()).find("no room"), std::string::npos);
    }
  }
}

std::vector<std::shared_ptr<Device>> devices(int count) {
  std::vector<std::shared_ptr<Device>> all;
  for (int i = 0; i < count; ++i) all.push_back(open_device({}));
  return all;
}

TEST_F(TrustTest, AnyNumberOfWorkersMakesTheSamePicture) {
  // oracle: one worker;  tolerance: none, bit for bit
  const RoomScene scene = prism();
  const RoomOptions options = in_passes(5);
  const RoomPicture one = render_room(scene, options, shared_device());
  for (const int count : {2, 3, 8}) expect_same(one, render_room(scene, options, devices(count)));
}

TEST_F(TrustTest, AnErrorToReachStopsWorkersAtTheSamePass) {
  // oracle: one worker;  tolerance: none
  const RoomScene scene = shipped_room("cornell", {"photons.emitted=20000", "spectrum.samples=2"});
  RoomOptions options;
  options.size = {16, 12};
  options.error_pct = 11;
  const RoomPicture one = render_room(scene, options, shared_device());
  ASSERT_GT(one.report.passes, 4);
  ASSERT_LT(one.report.passes, 60);
  expect_same(one, render_room(scene, options, devices(3)));
}

TEST_F(TrustTest, ACheckpointGoesOnWithAnotherNumberOfWorkers) {
  // oracle: one undisturbed worker;  tolerance: none
  const RoomScene scene = prism();
  RoomOptions options = in_passes(9);
  const RoomPicture whole = render_room(scene, options, shared_device());
  options.checkpoint = folder / "a.grck", options.checkpoint_seconds = 0;
  EXPECT_THROW(render_room(scene, stopped_at(options, 6), devices(2)), Interrupted);
  EXPECT_THROW(render_room(scene, stopped_at(options, 2), devices(3)), Interrupted);
  EXPECT_THROW(render_room(scene, stopped_at(options, 2), shared_device()), Interrupted);
  options.resume = RoomOptions::Resume::always;
  const RoomPicture resumed = render_room(scene, options, devices(2));
  EXPECT_GT(resumed.report.resumed_at, 1);
  expect_same(whole, resumed);
}

TEST_F(TrustTest, AWorkerThatFailsLeavesTheCheckpoint) {
  // oracle: exit 5 and the picture of an undisturbed run afterwards;  tolerance: none
  const RoomScene scene = prism();
  RoomOptions options = in_passes(7);
  const RoomPicture whole = render_room(scene, options, shared_device());
  options.checkpoint = folder / "a.grck";
  RoomOptions failing = options;
  failing.progress = [count = 0](const std::string &, double, double) mutable {
    if (++count == 6) throw RunError("the device is gone");
  };
  try {
    render_room(scene, failing, devices(3));
    ADD_FAILURE() << "no error";
  } catch (const Error &error) {
    EXPECT_EQ(error.exit_code(), ExitCode::stopped_early);
    EXPECT_NE(std::string(error.what()).find("the device is gone; checkpoint of"), std::string::npos) << error.what();
  }
  expect_same(whole, render_room(scene, options, shared_device()));
}

}  // namespace
}  // namespace greenray
