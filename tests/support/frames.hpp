#pragma once
/// \file
/// Helpers that read all frames of a stack, compare them, and return the message of a refusal.

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell {

inline bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// All frames of a stack. A returned frame does not change when the next one is read.
inline std::vector<cv::Mat> read_all(const std::filesystem::path& stack) {
  const auto source = imaging::open_frames(stack);
  std::vector<cv::Mat> frames;
  for (cv::Mat frame; source->next(frame);) frames.push_back(frame);
  return frames;
}

/// The message with which a stack is refused; empty if it is accepted.
inline std::string refusal(const std::filesystem::path& stack) {
  try {
    read_all(stack);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

inline void expect_words(const std::string& sentence, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(sentence.find(word), std::string::npos) << "'" << word << "' is not in: " << sentence;
}

}  // namespace twincell
