#pragma once
/// \file
/// The page of `locate --view`: frames, found beads, dropped candidates with their reasons, and what other
/// settings would keep.

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/output_kind.hpp"
#include "imaging/settings/found_settings.hpp"
#include "imaging/track/locating_request.hpp"

namespace twincell::cli {

/// The kind of output of the page.
inline Product locate_page() {
  return Product::text("a page of locate", "<!DOCTYPE html>\n<!-- twincell locate --view -->\n");
}

/// Collects the first frames with all their candidates, and writes the page.
///
/// The settings of the run are stored, and up to three of the others that were tried, by evidence; one of
/// them has the other polarity, with the diameters of the run if none was tried. The candidates of the others
/// are located here, so a frame costs up to four times as much as without the page.
class LocateView {
 public:
  static constexpr std::size_t kMaxFrames = 12;

  /// \pre `region` outlives this
  /// \param locator complete options of the run
  /// \param choice the settings tried
  LocateView(const imaging::LocatingRequest& request, const imaging::Region& region,
             const imaging::LocatorOptions& locator, const imaging::SettingsChoice& choice);

  /// Adds a frame; does nothing after kMaxFrames.
  /// \param grey the region as it was located
  /// \param located by the run, in px of the whole picture
  void add(std::int64_t number, const cv::Mat& grey, const imaging::Located& located);

  /// The page, which refers to no other file.
  /// \param stack, output names of the command
  /// \param frames number of frames of the run
  [[nodiscard]] std::string page(const std::string& stack, const std::string& output,
                                 std::int64_t frames) const;

 private:
  /// Settings whose candidates are stored.
  struct Stored {
    imaging::LocatorOptions options;
    nlohmann::json frames = nlohmann::json::array();  ///< list of candidates for each frame
  };
  /// The residual picture of a frame, as the address of the page.
  [[nodiscard]] std::string residual_of(const cv::Mat& grey, const imaging::Located& located) const;
  [[nodiscard]] nlohmann::json data(const std::string& command) const;

  imaging::LocatingRequest request_;
  const imaging::Region& region_;
  imaging::SettingsChoice choice_;
  std::vector<Stored> stored_;  ///< that of the run first
  /// For each of the settings tried, its index in stored_; else its size.
  std::vector<std::size_t> index_of_;
  nlohmann::json pictures_ = nlohmann::json::array();
  std::size_t beads_ = 0, dropped_ = 0;
};

}  // namespace twincell::cli
