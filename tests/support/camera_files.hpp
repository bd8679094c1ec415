#pragma once
/// \file
/// Files as cameras write them, written byte by byte by code that is independent of the readers.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace twincell {

/// Little-endian byte buffer that grows as it is written to.
class ByteWriter {
 public:
  /// Writes the low `n` bytes of `value` at byte `at`.
  ByteWriter& put(std::size_t at, std::uint64_t value, std::size_t n, bool big_first = false) {
    if (bytes_.size() < at + n) bytes_.resize(at + n, '\0');
    for (std::size_t i = 0; i < n; ++i)
      bytes_[at + (big_first ? n - 1 - i : i)] = static_cast<char>(value >> (8 * i) & 0xFF);
    return *this;
  }
  ByteWriter& put(std::size_t at, const std::string& text) {
    if (bytes_.size() < at + text.size()) bytes_.resize(at + text.size(), '\0');
    bytes_.replace(at, text.size(), text);
    return *this;
  }
  ByteWriter& put_real(std::size_t at, double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, 8);
    return put(at, bits, 8);
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const std::string& text() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Value of the pixel in a column and row (0 at the top) of a frame.
using PixelValue = std::function<unsigned(int x, int y, int frame)>;

/// Values of a row packed without gaps, most significant bit first.
inline std::string packed(const std::vector<unsigned>& values, int bits) {
  std::string out;
  int room = 0;
  for (const unsigned v : values)
    for (int b = bits - 1; b >= 0; --b) {
      if (room == 0) {
        out.push_back('\0');
        room = 8;
      }
      --room;
      out.back() = static_cast<char>(out.back() | ((v >> b & 1U) << room));
    }
  return out;
}

/// Pixels of one frame: 8 bits; 16 bits, little-endian; 24 bits (blue, green, red from the most significant
/// byte of the value); or packed.
inline std::string plane(int width, int height, int bits, int frame, const PixelValue& value,
                         bool bottom_up = false, bool big_first = false) {
  std::vector<unsigned> values;
  for (int row = 0; row < height; ++row)
    for (int x = 0; x < width; ++x) values.push_back(value(x, bottom_up ? height - 1 - row : row, frame));
  if (bits != 8 && bits != 16) return packed(values, bits);
  ByteWriter out;
  for (const unsigned v : values) out.put(out.size(), v, static_cast<std::size_t>(bits) / 8, big_first);
  return out.text();
}

struct CineSpec {
  int width = 6, height = 4, frames = 3;
  int container = 16;  ///< 8, 16; packed: 10, 12
  int real_bits = 12;
  int version = 1;
  unsigned packing = 0;  ///< 0; 256; 1024
  bool flip_v = false, flip_h = false, top_down = false;
  std::size_t setup_bytes = 1024;
  bool times = true;
  int first_image = -2;
  unsigned rate = 1000;
};

/// A Phantom cine file. Frame i is taken (first_image + i)/rate seconds after the trigger; the trigger is at
/// 1 600 000 000.25 s.
inline std::string cine_file(const CineSpec& c, const PixelValue& value) {
  ByteWriter w;
  const std::size_t setup = 84, tags = setup + c.setup_bytes;
  w.put(0, "CI").put(2, 44, 2).put(4, 0, 2).put(6, static_cast<std::uint64_t>(c.version), 2);
  w.put(16, static_cast<std::uint32_t>(c.first_image), 4).put(20, static_cast<std::uint64_t>(c.frames), 4);
  w.put(24, 44, 4).put(28, setup, 4);
  const std::uint64_t trigger = (std::uint64_t{1600000000} << 32) + (std::uint64_t{1} << 30);
  w.put(36, trigger, 8);
  w.put(44, 40, 4).put(48, static_cast<std::uint64_t>(c.width), 4);
  w.put(52, static_cast<std::uint32_t>(c.top_down ? -c.height : c.height), 4).put(56, 1, 2);
  w.put(58, c.packing != 0 ? 16 : static_cast<std::uint64_t>(c.container), 2).put(60, c.packing, 4);
  w.put(setup + c.setup_bytes - 1, 0, 1);
  w.put(setup, std::min(c.rate, 65535U), 2).put(setup + 140, "ST").put(setup + 142, c.setup_bytes, 2);
  if (c.setup_bytes >= 900) {
    w.put(setup + 756, c.flip_h ? 1 : 0, 4).put(setup + 760, c.flip_v ? 1 : 0, 4).put(setup + 768, c.rate, 4);
    w.put(setup + 896, static_cast<std::uint64_t>(c.real_bits), 4);
  }
  std::size_t at = tags;
  const auto n = static_cast<std::size_t>(c.frames);
  if (c.times) {
    w.put(at, 8 + 8 * n, 4).put(at + 4, 1002, 2).put(at + 6, 1, 2);
    for (std::size_t i = 0; i < n; ++i) {
      const double s = (c.first_image + static_cast<double>(i)) / c.rate;
      w.put(at + 8 + 8 * i, trigger + static_cast<std::uint64_t>(std::llround(std::ldexp(s, 32))), 8);
    }
    at += 8 + 8 * n;
    w.put(at, 8 + 4 * n, 4).put(at + 4, 1003, 2).put(at + 6, 0, 2);
    for (std::size_t i = 0; i < n; ++i) w.put(at + 8 + 4 * i, std::uint64_t{1} << 22, 4);  // 2^-10 s
    at += 8 + 4 * n;
  }
  w.put(32, at, 4);
  const std::size_t offset_bytes = c.version == 0 ? 4 : 8;
  std::size_t image = at + offset_bytes * n;
  for (std::size_t i = 0; i < n; ++i) {
    // A flip that the set-up requests is undone here, so that the displayed image equals `value`.
    const bool bottom_up = (c.packing == 0 && !c.top_down) != c.flip_v;
    const PixelValue seen = [&](int x, int y, int f) { return value(c.flip_h ? c.width - 1 - x : x, y, f); };
    const std::string pixels = plane(c.width, c.height, c.container, static_cast<int>(i), seen, bottom_up);
    w.put(at + offset_bytes * i, image, offset_bytes);
    w.put(image, 8, 4).put(image + 4, pixels.size(), 4).put(image + 8, pixels);
    image += 8 + pixels.size();
  }
  return w.text();
}

struct SeqSpec {
  int width = 6, height = 4, frames = 3;
  int bits = 8, real_bits = 8;
  int version = 5;
  bool counted = true;  ///< the header contains the number of frames
  unsigned format = 100, compression = 0;
};

/// A NorPix sequence. Consecutive frames are 2.5 ms apart (3 ms before version 5, which stores whole
/// milliseconds).
inline std::string seq_file(const SeqSpec& s, const PixelValue& value) {
  ByteWriter w;
  const std::size_t first = s.version >= 5 ? 8192 : 1024;
  const std::size_t bytes = static_cast<std::size_t>(s.width * s.height * s.bits / 8), stride = bytes + 24;
  w.put(0, 0xFEED, 4).put(28, static_cast<std::uint64_t>(s.version), 4).put(32, 1024, 4);
  w.put(548, static_cast<std::uint64_t>(s.width), 4).put(552, static_cast<std::uint64_t>(s.height), 4);
  w.put(556, static_cast<std::uint64_t>(s.bits), 4).put(560, static_cast<std::uint64_t>(s.real_bits), 4);
  w.put(564, bytes, 4)
      .put(568, s.format, 4)
      .put(572, s.counted ? static_cast<std::uint64_t>(s.frames) : 0, 4);
  w.put(580, stride, 4).put_real(584, 400).put(620, s.compression, 4).put(first - 1, 0, 1);
  for (int i = 0; i < s.frames; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i) * stride;
    w.put(at, plane(s.width, s.height, s.bits, i, value)).put(at + stride - 1, 0, 1);
    const auto us = static_cast<std::uint64_t>(999000 + (s.version >= 5 ? 2500 : 3000) * i);
    w.put(at + bytes, 1600000000 + us / 1000000, 4).put(at + bytes + 4, us / 1000 % 1000, 2);
    if (s.version >= 5) w.put(at + bytes + 6, us % 1000, 2);
  }
  return w.text();
}

/// An IDT multi-page raw file, whose header states the length 84 as the manual does.
inline std::string mrf_file(int width, int height, int frames, int bits, const PixelValue& value) {
  ByteWriter w;
  w.put(0, "IDT-MRF").put(8, 0, 4).put(12, 84, 4).put(16, static_cast<std::uint64_t>(frames), 4);
  w.put(20, static_cast<std::uint64_t>(width), 4).put(24, static_cast<std::uint64_t>(height), 4);
  w.put(28, static_cast<std::uint64_t>(bits), 4).put(95, 0, 1);
  for (int i = 0; i < frames; ++i)
    w.put(w.size(), plane(width, height, bits == 8 || bits == 24 ? bits : 16, i, value));
  return w.text();
}

/// The text file that accompanies a Photron .mraw.
inline std::string cih_text(int width, int height, int frames, int bits, int depth,
                            const std::string& side = "Lower") {
  return "#Camera Information Header\r\nDate : 2020/1/1\r\nCamera Type : FASTCAM\r\nRecord Rate(fps) : "
         "2000\r\n"
         "Shutter Speed(s) : 1/4000\r\nTotal Frame : " +
         std::to_string(frames) +
         "\r\nOriginal Total Frame : 99\r\nStart Frame : -5\r\nImage Width : " + std::to_string(width) +
         "\r\nImage Height : " + std::to_string(height) +
         "\r\nColor Type : Mono\r\nColor Bit : " + std::to_string(bits) +
         "\r\nFile Format : MRaw\r\nEffectiveBit Depth : " + std::to_string(depth) +
         "\r\nEffectiveBit Side : " + side + "\r\nEND\r\n";
}

/// The same information as .cihx: XML between bytes that are not XML.
inline std::string cihx_text(int width, int height, int frames, int bits, int depth) {
  return std::string("\x01\x02\0junk", 7) +
         "<?xml version=\"1.0\"?>\n<cih>\n<fileInfo><date>2020/1/1</date></fileInfo>" +
         "<frameInfo><totalFrame>" + std::to_string(frames) +
         "</totalFrame><startFrame>-5</startFrame></frameInfo><recordInfo><recordRate>2000</recordRate>" +
         "<shutterSpeed>0.00025</shutterSpeed></recordInfo><imageDataInfo><resolution><width>" +
         std::to_string(width) + "</width><height>" + std::to_string(height) +
         "</height></resolution><colorInfo><type>Mono</type><bit>" + std::to_string(bits) +
         "</bit></colorInfo><effectiveBit><depth>" + std::to_string(depth) +
         "</depth><side>Lower</side></effectiveBit></imageDataInfo><imageFileInfo><fileFormat>MRaw</"
         "fileFormat>" +
         "</imageFileInfo></cih>\n\xff\xfe";
}

inline std::string planes(int width, int height, int frames, int bits, const PixelValue& value) {
  std::string all;
  for (int i = 0; i < frames; ++i) all += plane(width, height, bits, i, value);
  return all;
}

struct TiffSpec {
  int width = 32, height = 20, pages = 3;
  int bits = 16;
  bool big_first = false, big_tiff = false;
  int photometric = 1;
  std::string description;
  int pages_written =
      -1;  ///< number of directories; the planes of the other pages follow without one; -1: as many as pages
  int max_sample = 0;
  bool only_head = false;  ///< omit the pixels of all but the first page
};

/// An uncompressed TIFF, one strip per page.
inline std::string tiff_file(const TiffSpec& t, const PixelValue& value) {
  ByteWriter w;
  // Header, and the description if there is one.
  const std::size_t word = t.big_tiff ? 8 : 4;
  const auto put = [&](std::size_t at, std::uint64_t v, std::size_t n) { w.put(at, v, n, t.big_first); };
  w.put(0, t.big_first ? "MM" : "II");
  put(2, t.big_tiff ? 43 : 42, 2);
  if (t.big_tiff) put(4, 8, 2);
  std::size_t link = t.big_tiff ? 8 : 4;  // position of the next directory's offset
  put(link, 0, word);
  std::size_t text_at = 0;
  if (!t.description.empty()) {
    text_at = 16;
    w.put(text_at, t.description + '\0');
  }
  const std::size_t row = static_cast<std::size_t>(t.width * t.bits + 7) / 8,
                    bytes = row * static_cast<std::size_t>(t.height);
  const int directories = t.pages_written < 0 ? t.pages : t.pages_written;
  for (int i = 0; i < t.pages; ++i) {
    if (i >= directories && t.only_head) break;
    // Pixels of the page.
    std::string pixels;
    if (t.bits > 8 && t.bits < 16) {  // rows begin at byte boundaries
      for (int y = 0; y < t.height; ++y)
        pixels += plane(t.width, 1, t.bits, i, [&](int x, int, int f) { return value(x, y, f); });
    } else {
      pixels = plane(t.width, t.height, t.bits, i, value, false, t.big_first);
    }
    if (i >= directories) {
      w.put(w.size(), pixels);
      continue;
    }
    struct Entry {
      std::uint64_t tag, type, n, value;
    };
    // Entries of the directory, in ascending order of the tag.
    std::vector<Entry> entries = {{256, 4, 1, static_cast<std::uint64_t>(t.width)},
                                  {257, 4, 1, static_cast<std::uint64_t>(t.height)},
                                  {258, 3, 1, static_cast<std::uint64_t>(t.bits)},
                                  {259, 3, 1, 1},
                                  {262, 3, 1, static_cast<std::uint64_t>(t.photometric)}};
    if (text_at > 0 && i == 0) entries.push_back({270, 2, t.description.size() + 1, text_at});
    entries.push_back({273, 4, 1, 0});
    entries.push_back({277, 3, 1, 1});
    entries.push_back({278, 4, 1, static_cast<std::uint64_t>(t.height)});
    entries.push_back({279, 4, 1, bytes});
    if (t.max_sample > 0) entries.push_back({281, 3, 1, static_cast<std::uint64_t>(t.max_sample)});
    // Directory: the previous one links to it, and the pixels follow it.
    const std::size_t at = (w.size() + 7) / 8 * 8;
    put(link, at, word);
    const std::size_t count = t.big_tiff ? 8 : 2, each = t.big_tiff ? 20 : 12;
    put(at, entries.size(), count);
    link = at + count + entries.size() * each;
    put(link, 0, word);
    for (std::size_t e = 0; e < entries.size(); ++e) {
      const std::size_t here = at + count + e * each;
      if (entries[e].tag == 273) entries[e].value = link + word;
      put(here, entries[e].tag, 2);
      put(here + 2, entries[e].type, 2);
      put(here + 4, entries[e].n, word);
      put(here + 4 + word, 0, word);
      put(here + 4 + word, entries[e].value,
          entries[e].type == 3 ? 2
          : 4 > word           ? word
                               : (t.big_tiff && entries[e].type == 2 ? 8 : 4));
    }
    w.put(w.size(), pixels);
  }
  return w.text();
}

}  // namespace twincell
