// Vision Research Phantom .cine: header "CI", BITMAPINFOHEADER, camera set-up "ST", tagged blocks (times,
// exposures), table of offsets, images. Layout: Vision Research, "Cine file format"; soft-matter/pims
// pims/cine.py; FFmpeg libavformat/cinedec.c.

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "imaging/stack/formats/raw_stack.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

// The camera compands packed 10-bit values. The manufacturer's look-up table is the inverse of ITU-R BT.709's
// transfer function (V < 0.081: V/4.5, else ((V + 0.099)/1.099)^(1/0.45)) between black (64 of 1024 and of
// 4096) and white (1014 of 1024 and 4064 of 4096). Values above white are saturated.
std::array<std::uint16_t, 1024> expansion() {
  std::array<std::uint16_t, 1024> table{};
  for (int code = 0; code < 1024; ++code) {
    const double v = (code - 64) / 950.0;
    const double light = v < 0.081 ? v / 4.5 : std::pow((v + 0.099) / 1.099, 1 / 0.45);
    table[static_cast<std::size_t>(code)] =
        code > 1014 ? 4095 : static_cast<std::uint16_t>(std::lround(64 + 4000 * light));
  }
  return table;
}

class Cine final : public RawStack {
 public:
  explicit Cine(const std::filesystem::path& file) : RawStack(file) {
    read_header();
    read_setup();
    read_tags();
    require_frames();
    require_last(place(frames_ - 1));
    set_stamped_rate(stamp_s(0), stamp_s(frames_ - 1));
  }

 private:
  void read_header() {
    const std::uint64_t compression = in_.number(4, 2, "the cine header");
    const std::uint64_t version = in_.number(6, 2, "the cine header");
    if (version > 1) in_.refuse(fmt::format("is a cine file of version {}; 0 and 1 can be read.", version));
    if (compression == 1) in_.refuse("is a JPEG-compressed cine file; save it uncompressed or packed.");
    info_.first_number = in_.i32(16, "the cine header");
    frames_ = in_.u32(20, "the cine header");
    picture_at_ = in_.u32(24, "the cine header");
    setup_at_ = in_.u32(28, "the cine header");
    offsets_at_ = in_.u32(32, "the cine header");
    trigger_ = in_.number(36, 8, "the cine header") & kTimeMask;
    offset_bytes_ = version == 0 ? 4 : 8;
    in_.require(offsets_at_, frames_ * offset_bytes_, fmt::format("the table of its {} images", frames_));

    const std::int32_t width = in_.i32(picture_at_ + 4, "the picture header");
    const std::int32_t height = in_.i32(picture_at_ + 8, "the picture header");
    const std::uint64_t bits = in_.number(picture_at_ + 14, 2, "the picture header");
    const std::uint32_t packing = in_.u32(picture_at_ + 16, "the picture header");
    if (width < 1 || height == 0 || height == INT32_MIN)
      in_.refuse(fmt::format("states images of {} x {} pixels.", width, height));
    if (packing != 0 && packing != kPacked10 && packing != kPacked12)
      in_.refuse(
          fmt::format("uses pixel packing {}; 0, {} and {} can be read.", packing, kPacked10, kPacked12));
    if (packing == 0 && bits != 8 && bits != 16 && bits != 24 && bits != 48)
      in_.refuse(
          fmt::format("has {} bits per pixel; 8, 16, 24 or 48 can be read, or packed 10 or 12.", bits));
    // Files of both packings use the number 256; the size of an image distinguishes them. As in any BMP, the
    // bottom row comes first unless the height is negative; packed images begin with the top row.
    layout_.bottom_up = packing == 0 && height > 0;
    set_layout(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(std::abs(height)),
               packing == 0 ? static_cast<int>(bits) : 12);
    if (packing == kPacked10 && frames_ > 0 && image_bytes(0) < layout_.bytes()) layout_.stored_bits = 10;
  }
  void read_setup() {
    if (in_.number(setup_at_ + 140, 2, "the camera set-up") != 0x5453)
      in_.refuse(fmt::format("is damaged: the camera set-up at byte {} has no mark ST.", setup_at_));
    setup_bytes_ = in_.number(setup_at_ + 142, 2, "the camera set-up");
    in_.require(setup_at_, setup_bytes_, "the camera set-up");
    // Older cameras write a shorter set-up; fields beyond its end read as 0.
    const auto field = [&](std::uint64_t at) -> std::uint32_t {
      return at + 4 <= setup_bytes_ ? in_.u32(setup_at_ + at, "the camera set-up") : 0;
    };
    constexpr std::uint64_t flip_h = 756, flip_v = 760, rate = 768, shutter_us = 772, cfa = 808,
                            real_bits = 896;
    if (field(flip_v) != 0) layout_.bottom_up = !layout_.bottom_up;
    layout_.mirrored = field(flip_h) != 0;
    const std::uint32_t hz = field(rate) > 0
                                 ? field(rate)
                                 : static_cast<std::uint32_t>(in_.number(setup_at_, 2, "the camera set-up"));
    if (hz > 0) info_.frame_rate_hz = hz;
    if (field(shutter_us) > 0) info_.exposure_s = 1e-6 * field(shutter_us);
    if ((field(cfa) & 0xFFFFFFU) != 0 && layout_.stored_bits <= 16)
      in_.refuse("holds a colour camera's mosaic, not grey values; save it as grey or as 24-bit colour.");

    const std::uint32_t real = field(real_bits);
    const int container = layout_.stored_bits >= 24 ? layout_.stored_bits / 3 : layout_.stored_bits;
    info_.bits =
        real >= 1 && real <= static_cast<std::uint32_t>(container) ? static_cast<int>(real) : container;
    info_.format = layout_.stored_bits == 10   ? "Phantom cine, packed 10 bit"
                   : layout_.stored_bits == 12 ? "Phantom cine, packed 12 bit"
                                               : fmt::format("Phantom cine, {} bit", layout_.stored_bits);
    if (layout_.stored_bits == 10) {
      info_.bits = 12;
      info_.notes.emplace_back(
          "packed 10-bit values are companded by the camera; they are converted to linear 12-bit values.");
    }
  }
  // Reads the blocks {size, kind, whether more follow, data} between the set-up and the table of offsets.
  void read_tags() {
    std::uint64_t at = setup_at_ + setup_bytes_;
    for (int blocks = 0; blocks < 64 && at + 8 <= offsets_at_ && at + 8 <= in_.size(); ++blocks) {
      const std::uint64_t size = in_.u32(at, "a tagged block");
      const std::uint64_t kind = in_.number(at + 4, 2, "a tagged block");
      const bool more = in_.number(at + 6, 2, "a tagged block") != 0;
      if (size < 8) break;
      if (kind == 1002 && (size - 8) / 8 >= frames_) {
        in_.require(at, size, "the block of time stamps");
        times_at_ = at + 8;
        info_.time_origin = "trigger";
        info_.recorded_unix = static_cast<std::int64_t>(trigger_ >> 32);
      }
      if (kind == 1003 && (size - 8) / 4 >= frames_) {
        in_.require(at, size, "the block of exposures");
        info_.exposure_s = in_.u32(at + 8, "an exposure") * 0x1p-32;
      }
      if (!more) break;
      at += size;
    }
  }
  [[nodiscard]] std::uint64_t offset(std::uint64_t i) const {
    return in_.number(offsets_at_ + i * offset_bytes_, offset_bytes_, "the table of images");
  }
  // An image begins with an annotation, whose last four bytes are the size of the pixel data that follow it.
  [[nodiscard]] std::uint64_t annotation_bytes(std::uint64_t i) const {
    const std::uint64_t n = in_.u32(offset(i), name(i));
    if (n < 8) in_.refuse(fmt::format("is damaged: the annotation of {} has {} bytes.", name(i), n));
    return n;
  }
  [[nodiscard]] std::uint64_t image_bytes(std::uint64_t i) const {
    return in_.u32(offset(i) + annotation_bytes(i) - 4, name(i));
  }
  [[nodiscard]] std::uint64_t place(std::uint64_t i) const override {
    if (image_bytes(i) < layout_.bytes())
      in_.refuse(fmt::format("is damaged: {} has {} bytes, {} x {} pixels of {} bits need {}.", name(i),
                             image_bytes(i), layout_.width, layout_.height, layout_.stored_bits,
                             layout_.bytes()));
    return offset(i) + annotation_bytes(i);
  }
  [[nodiscard]] std::optional<double> stamp_s(std::uint64_t i) const override {
    if (times_at_ == 0) return {};
    const std::uint64_t stamp = in_.number(times_at_ + 8 * i, 8, "a time stamp") & kTimeMask;
    return static_cast<double>(static_cast<std::int64_t>(stamp - trigger_)) * 0x1p-32;
  }
  [[nodiscard]] std::string name(std::uint64_t i) const override {
    return fmt::format("frame {} (image {})", i, *info_.first_number + static_cast<std::int64_t>(i));
  }
  void finish(cv::Mat& frame) const override {
    if (layout_.stored_bits != 10) return;
    static const std::array<std::uint16_t, 1024> table = expansion();
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x) {
        auto& pixel = frame.at<std::uint16_t>(y, x);
        pixel = table[pixel];
      }
  }

  static constexpr std::uint32_t kPacked10 = 256, kPacked12 = 1024;
  // Times are in units of 2^-32 s; the two lowest bits are flags.
  static constexpr std::uint64_t kTimeMask = ~std::uint64_t{3};
  std::uint64_t picture_at_ = 0, setup_at_ = 0, setup_bytes_ = 0, offsets_at_ = 0, offset_bytes_ = 8;
  std::uint64_t trigger_ = 0, times_at_ = 0;
};

}  // namespace

extern const Reader cine_reader;
const Reader cine_reader = {
    .extensions = ".cine",
    .owns =
        [](const Head& head) {
          return head.starts_with({"CI\x2c\0", 4});
        },
    .open = [](const std::filesystem::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      return std::make_unique<Cine>(file);
    }};

}  // namespace twincell::imaging::frames
