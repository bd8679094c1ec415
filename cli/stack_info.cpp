#include "cli/stack_info.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "cli/output.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/stack/repeated_frames.hpp"

namespace twincell::cli {

namespace {

struct Values {
  double smallest = INFINITY, largest = -INFINITY, sum = 0;
  std::size_t at_largest = 0, n = 0;
  std::uint32_t any_bits = 0;  ///< bits that are set in at least one integer value

  template <class Pixel>
  void take(const cv::Mat& frame) {
    for (int y = 0; y < frame.rows; ++y) {
      const auto* row = frame.ptr<Pixel>(y);
      for (int x = 0; x < frame.cols; ++x) {
        const auto v = static_cast<double>(row[x]);
        if (v > largest) at_largest = 0;
        smallest = std::min(smallest, v);
        largest = std::max(largest, v);
        at_largest += v == largest ? 1 : 0;
        if constexpr (std::is_integral_v<Pixel>) any_bits |= row[x];
        sum += v;
        ++n;
      }
    }
  }
};

// Adds notes on suspicious grey values of the first frame: constant, saturated, shifted, or above the stated
// depth.
void judge_values(const Values& v, const imaging::StackInfo& info, bool whole_numbers, nlohmann::json& d) {
  if (v.smallest == v.largest) {
    d["notes"].push_back(
        fmt::format("every pixel of the first frame has the value {:g}: the frame is blank.", v.largest));
    return;
  }
  const double share = static_cast<double>(v.at_largest) / static_cast<double>(v.n);
  // A camera saturates at the full scale of its own bit depth, which can be smaller than the depth of the
  // file.
  const auto whole = static_cast<std::uint64_t>(std::max(0.0, v.largest));
  const bool full_scale = whole_numbers && whole >= 255 && std::has_single_bit(whole + 1);
  if (full_scale && share > 0.01)
    d["notes"].push_back(
        fmt::format("{:.1f} % of the first frame's pixels are {:g}, the full scale of {} bits: saturated.",
                    100 * share, v.largest, std::bit_width(whole)));
  if (const int empty = std::countr_zero(v.any_bits); whole_numbers && v.largest > 4095 && empty >= 2)
    d["notes"].push_back(
        fmt::format("every value of the first frame is a multiple of {}: these may be {}-bit values that "
                    "were shifted up.",
                    1 << empty, 16 - empty));
  if (!whole_numbers || !info.bits) return;
  const int needed = std::bit_width(static_cast<unsigned>(v.largest));
  if (needed > *info.bits)
    d["notes"].push_back(
        fmt::format("the first frame's largest value, {:g}, needs {} bits, more than the {} stated.",
                    v.largest, needed, *info.bits));
}

}  // namespace

std::unique_ptr<imaging::FrameSource> open_stack(const std::filesystem::path& stack, const Common& common) {
  auto frames = imaging::open_frames(stack);
  for (const std::string& sentence : frames->info().notes) note(common, stack.string() + ": " + sentence);
  return frames;
}

bool is_trajectory(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  const h5::Handle opened = h5::open_file(file);
  return opened ? h5::exists(opened.get(), "h5md") : file.extension() == ".h5";
}

nlohmann::json describe_stack(const std::filesystem::path& stack) {
  const auto frames = imaging::open_frames(stack);
  cv::Mat frame;
  (void)frames->next(frame);
  const imaging::StackInfo info = frames->info();
  Values v;
  if (frame.depth() == CV_8U) v.take<std::uint8_t>(frame);
  if (frame.depth() == CV_16U) v.take<std::uint16_t>(frame);
  if (frame.depth() == CV_32F) v.take<float>(frame);
  const bool whole_numbers = frame.depth() != CV_32F;
  nlohmann::json d = {
      {"file", stack.string()},
      {"kind", "frames"},
      {"format", info.format},
      {"width", frame.cols},
      {"height", frame.rows},
      {"frames", frames->announced()},
      {"pixel_type", frame.depth() == CV_8U    ? "uint8"
                     : frame.depth() == CV_16U ? "uint16"
                                               : "float32"},
      {"first_frame", {{"min", v.smallest}, {"max", v.largest}, {"mean", v.sum / static_cast<double>(v.n)}}},
      {"notes", info.notes}};
  if (info.bits) d["bits"] = *info.bits;
  if (whole_numbers) d["first_frame"]["bits"] = std::bit_width(static_cast<unsigned>(v.largest));
  d["first_frame"]["share_at_max"] = static_cast<double>(v.at_largest) / static_cast<double>(v.n);
  if (info.frame_rate_hz) d["frame_rate_hz"] = *info.frame_rate_hz;
  if (info.playback) d["playback"] = true;
  if (info.stamped_rate_hz) d["stamped_rate_hz"] = *info.stamped_rate_hz;
  if (info.exposure_s) d["exposure_s"] = *info.exposure_s;
  if (info.first_number) d["first_number"] = *info.first_number;
  if (info.recorded_unix) d["recorded_unix"] = *info.recorded_unix;
  if (info.other_files > 0) d["other_files"] = info.other_files;
  judge_values(v, info, whole_numbers, d);
  const auto first = frames->time_s();
  if (first) d["time"] = {{"origin", info.time_origin}, {"first_s", *first}};
  // Reading all frames would take minutes. The second stamp is enough to judge the stamps; frames that a
  // conversion of the frame rate repeats return every few frames.
  constexpr std::size_t kMaxRead = 100;
  imaging::RepeatedFrames repeated;
  repeated.add(frame);
  std::size_t read = 1;
  try {
    for (; read < kMaxRead && frames->next(frame); ++read) {
      if (first && read == 1) d["time"]["second_s"] = *frames->time_s();
      repeated.add(frame);
    }
  } catch (const InputError& e) {
    d["notes"].push_back(fmt::format("frame {} cannot be read: {}", read, e.what()));
  }
  if (const std::string repeats = imaging::repeats_in_words(repeated.repeats()); !repeats.empty())
    d["notes"].push_back((read == kMaxRead ? "at the beginning, " : "") + repeats + ".");
  return d;
}

std::string stack_as_text(const nlohmann::json& d) {
  const auto& first = d["first_frame"];
  std::string s = fmt::format("{}\n  format      {}\n  frames      {}\n  size        {} x {} px\n",
                              d["file"].get<std::string>(), d["format"].get<std::string>(),
                              d["frames"].get<std::size_t>(), d["width"].get<int>(), d["height"].get<int>());
  s += fmt::format("  depth       {}", d["pixel_type"].get<std::string>());
  if (d.contains("bits")) s += fmt::format(", {} bits as stated by the file", d["bits"].get<int>());
  if (first.contains("bits")) s += fmt::format(", {} needed by the first frame", first["bits"].get<int>());
  s += fmt::format("\n  first frame {:g} to {:g}, mean {:.2f}\n", first["min"].get<double>(),
                   first["max"].get<double>(), first["mean"].get<double>());
  if (d.contains("frame_rate_hz"))
    s += fmt::format("  rate        {:g} frames/s {}\n", d["frame_rate_hz"].get<double>(),
                     d.contains("playback") ? "of playback; state the camera's rate as camera.frame_rate_hz"
                                            : "as stated by the file");
  if (d.contains("stamped_rate_hz"))
    s += fmt::format("  rate        {:.6g} frames/s from the time stamps\n",
                     d["stamped_rate_hz"].get<double>());
  if (d.contains("exposure_s")) s += fmt::format("  exposure    {:g} s\n", d["exposure_s"].get<double>());
  if (d.contains("first_number"))
    s += fmt::format("  numbers     from {}; 0 is the trigger\n", d["first_number"].get<std::int64_t>());
  if (d.contains("time")) {
    s += fmt::format("  time stamps first frame {:+.9f} s", d["time"]["first_s"].get<double>());
    if (d["time"].contains("second_s"))
      s += fmt::format(", second {:+.9f} s", d["time"]["second_s"].get<double>());
    s += fmt::format(", counted from the {}", d["time"]["origin"].get<std::string>());
    if (d.contains("recorded_unix"))
      s += fmt::format(" at {:%Y-%m-%d %H:%M:%S} UTC",
                       fmt::gmtime(static_cast<std::time_t>(d["recorded_unix"].get<std::int64_t>())));
    s += "\n";
  } else {
    s += "  time stamps none\n";
  }
  if (d.contains("other_files"))
    s += fmt::format("  other files {}, not pictures, ignored\n", d["other_files"].get<std::size_t>());
  for (const auto& sentence : d["notes"]) s += "  note        " + sentence.get<std::string>() + "\n";
  return s;
}

}  // namespace twincell::cli
