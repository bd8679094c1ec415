// NorPix StreamPix .seq: a header, then images at equal strides, each followed by its time stamp.
// Layout: NorPix, "Sequence file format"; soft-matter/pims pims/norpix_reader.py.

#include <fmt/format.h>

#include "imaging/stack/formats/raw_stack.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

class Seq final : public RawStack {
 public:
  explicit Seq(const std::filesystem::path& file) : RawStack(file) {
    const std::string header = "the sequence header";
    const std::int32_t version = in_.i32(28, header);
    const std::uint32_t width = in_.u32(548, header), height = in_.u32(552, header);
    const std::uint32_t bits = in_.u32(556, header), real_bits = in_.u32(560, header);
    image_bytes_ = in_.u32(564, header);
    const std::uint32_t format = in_.u32(568, header);
    frames_ = in_.u32(572, header);
    stride_ = in_.u32(580, header);
    const double rate = in_.f64(584, header);
    if (const std::uint32_t compression = in_.u32(620, header); compression != 0)
      in_.refuse(fmt::format("is a compressed sequence (compression {}); only uncompressed ones can be read.",
                             compression));
    constexpr std::uint32_t mono = 100, bgr = 200;
    if (!(format == mono && (bits == 8 || bits == 16)) && !(format == bgr && bits == 24))
      in_.refuse(
          fmt::format("has images of format {} with {} bits per pixel; format {} (grey) with 8 or 16 and "
                      "format {} (BGR) with 24 can be read.",
                      format, bits, mono, bgr));
    set_layout(width, height, static_cast<int>(bits));
    if (image_bytes_ < layout_.bytes())
      in_.refuse(fmt::format("states that an image has {} bytes; {} x {} pixels of {} bits need {}.",
                             image_bytes_, width, height, bits, layout_.bytes()));
    // Since version 5 (StreamPix 6) the header is longer and time stamps include microseconds.
    first_ = version >= 5 ? 8192 : 1024;
    stamp_bytes_ = version >= 5 ? 8 : 6;
    if (stride_ < image_bytes_ + stamp_bytes_)
      in_.refuse(fmt::format("states that images are {} bytes apart; an image and its time stamp need {}.",
                             stride_, image_bytes_ + stamp_bytes_));
    if (frames_ == 0 && in_.size() > first_) {
      frames_ = (in_.size() - first_) / stride_;
      info_.notes.push_back(fmt::format(
          "the header counts no frames (a recording that was not closed?); the file has room for {}.",
          frames_));
    }
    const std::uint32_t container = bits == 24 ? 8 : bits;
    info_.bits = static_cast<int>(real_bits >= 1 && real_bits <= container ? real_bits : container);
    info_.format = fmt::format("NorPix sequence, {} bit", bits);
    if (rate > 0 && rate < 1e9) info_.frame_rate_hz = rate;
    require_frames();
    require_last(place(frames_ - 1));
    start_us_ = clock_us(0);
    info_.time_origin = "first frame";
    info_.recorded_unix = start_us_ / 1'000'000;
    set_stamped_rate(stamp_s(0), stamp_s(frames_ - 1));
  }

 private:
  [[nodiscard]] std::uint64_t place(std::uint64_t i) const override {
    in_.require(first_ + i * stride_, image_bytes_ + stamp_bytes_, name(i));
    return first_ + i * stride_;
  }
  [[nodiscard]] std::optional<double> stamp_s(std::uint64_t i) const override {
    return 1e-6 * static_cast<double>(clock_us(i) - start_us_);
  }
  // Time stamp of image i by the camera's clock, microseconds since 1970. The file stores whole seconds,
  // milliseconds and, since version 5, microseconds.
  [[nodiscard]] std::int64_t clock_us(std::uint64_t i) const {
    const std::uint64_t at = place(i) + image_bytes_;
    const auto part = [&](std::uint64_t from, std::size_t n) {
      return static_cast<std::int64_t>(in_.number(at + from, n, "a time stamp"));
    };
    return 1'000'000 * part(0, 4) + 1000 * part(4, 2) + (stamp_bytes_ == 8 ? part(6, 2) : 0);
  }

  std::uint64_t first_ = 0, stride_ = 0, image_bytes_ = 0, stamp_bytes_ = 0;
  std::int64_t start_us_ = 0;
};

}  // namespace

extern const Reader seq_reader;
const Reader seq_reader = {
    .extensions = ".seq",
    .owns =
        [](const Head& head) {
          return head.starts_with({"\xED\xFE\0\0", 4});
        },
    .open = [](const std::filesystem::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      return std::make_unique<Seq>(file);
    }};

}  // namespace twincell::imaging::frames
