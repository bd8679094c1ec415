#include "imaging/stack/different_stacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kFirst = 8;

std::vector<cv::Mat> first_frames(const std::filesystem::path& stack) {
  const auto frames = open_frames(stack);
  std::vector<cv::Mat> first;
  for (cv::Mat m; first.size() < kFirst && frames->next(m); m = cv::Mat()) first.push_back(m.clone());
  return first;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

}  // namespace

void require_different_stacks(const std::vector<std::filesystem::path>& stacks) {
  std::vector<std::vector<cv::Mat>> first;
  for (const std::filesystem::path& stack : stacks) {
    first.push_back(first_frames(stack));
    for (std::size_t i = 0; i + 1 < first.size(); ++i)
      if (!first[i].empty() && std::ranges::equal(first[i], first.back(), same))
        throw ConfigError(
            {.file = stack.string()},
            fmt::format("begins with the same pictures as {}; name each film once.", stacks[i].string()));
  }
}

}  // namespace twincell::imaging
