#pragma once
/// \file
/// A file of uncompressed frames: the common base of the readers of camera files.

#include <optional>
#include <string>
#include <vector>

#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/raw_pixels.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging::frames {

/// A derived class reads its header in its constructor, where it sets frames_, layout_ and info_, and
/// implements place(), the position of a frame.
class RawStack : public FrameSource {
 public:
  bool next(cv::Mat& frame) override;
  [[nodiscard]] std::size_t announced() const override { return frames_; }
  [[nodiscard]] std::string current() const override;
  [[nodiscard]] StackInfo info() const override { return info_; }
  [[nodiscard]] std::optional<double> time_s() const override { return time_; }

 protected:
  explicit RawStack(const std::filesystem::path& file) : in_(file) {}

  /// Position in the file of the first byte of frame i, from 0.
  /// \throws InputError if the frame is incomplete
  [[nodiscard]] virtual std::uint64_t place(std::uint64_t i) const = 0;
  /// Time stamp of frame i, s after info_.time_origin.
  [[nodiscard]] virtual std::optional<double> stamp_s(std::uint64_t /*i*/) const { return {}; }
  /// Further conversion of the unpacked values.
  virtual void finish(cv::Mat& /*frame*/) const {}
  /// Name of frame i for messages, counted from 1: "frame 3".
  [[nodiscard]] virtual std::string name(std::uint64_t i) const;

  /// Sets layout_ and info_ from a header.
  /// \throws InputError if the frame size is not plausible for a file of this size
  void set_layout(std::uint64_t width, std::uint64_t height, int stored_bits);
  /// To be called at the end of a constructor.
  /// \throws InputError if there are no frames
  void require_frames() const;
  /// \throws InputError if the file ends before its last frame, which begins at `last`
  void require_last(std::uint64_t last) const;
  /// Sets info_.stamped_rate_hz from the time stamps of the first and the last frame. Adds a note if it
  /// differs from the stated rate by more than 1 %.
  void set_stamped_rate(std::optional<double> first_s, std::optional<double> last_s);

  ByteFile in_;
  StackInfo info_;
  RawLayout layout_;
  std::uint64_t frames_ = 0;

 private:
  std::uint64_t read_ = 0;
  std::optional<double> time_;
  std::vector<std::uint8_t> raw_;
};

}  // namespace twincell::imaging::frames
