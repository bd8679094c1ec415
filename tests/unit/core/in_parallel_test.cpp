#include "core/in_parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/temporary_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::in_parallel_test {
namespace {

TEST(InParallel, EveryJobIsDoneOnce) {
  for (const std::size_t n : {0U, 1U, 7U, 1000U})
    for (const int threads : {-1, 1, 2, 5}) {
      std::vector<std::atomic<int>> done(n);
      in_parallel(n, threads, [&](std::size_t i) { ++done[i]; });
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(done[i], 1) << i << " of " << n << ", " << threads;
    }
}

TEST(InParallel, JobsRunSideBySideOnAsManyThreadsAsAsked) {
  // Each task waits for the others: with fewer active threads they would wait for ever.
  constexpr int kThreads = 3;
  std::latch all_run(kThreads);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  in_parallel(kThreads, kThreads, [&](std::size_t) {
    all_run.arrive_and_wait();
    const std::scoped_lock lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(seen.size(), std::size_t{kThreads});
  EXPECT_TRUE(seen.contains(std::this_thread::get_id()));

  const auto caller = std::this_thread::get_id();
  in_parallel(5, 1, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(InParallel, TheFirstFailureIsThrownAndNothingBeginsAfterIt) {
  for (const int threads : {1, 2, 4}) {
    std::atomic<int> begun{0};
    std::latch later_fails(1);
    try {
      in_parallel(100000, threads, [&](std::size_t i) {
        ++begun;
        // The later task fails first, while the earlier one is still running.
        if (i == 11) later_fails.count_down();
        if (i == 10 && threads > 1) later_fails.wait();
        if (i == 10 || i == 11) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "10") << threads;
    }
    EXPECT_GE(begun, 11);
    EXPECT_LT(begun, 100000);
  }
}

// Also run under the thread sanitizer, like all tests here.
TEST(InParallel, ManyThreadsMakeAndForgetTemporaries) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> kept(40);
  in_parallel(400, 4, [&](std::size_t i) {
    // Names of different lengths, so that one name that overwrites another would be visible.
    const auto path = make_temporary(folder.path() / std::string(1 + i % 7, 'x'), false);
    if (i % 10 == 0)
      kept[i / 10] = path;
    else
      forget_temporary(path);
  });
  remove_temporaries();
  std::size_t left = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    left += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(left, 360U);
  for (const auto& path : kept) {
    EXPECT_FALSE(std::filesystem::exists(path)) << path;
    forget_temporary(path);
  }
}

}  // namespace
}  // namespace twincell::in_parallel_test
