// Stacks of frames in Python.

#include "python/frames.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::python {

namespace {

/// Pictures that a Python iterator gives.
class IteratedFrames : public imaging::FrameSource {
 public:
  IteratedFrames(const py::object& pictures, std::size_t announced)
      : pictures_(py::reinterpret_steal<py::object>(PyObject_GetIter(pictures.ptr()))),
        announced_(announced) {
    if (!pictures_) throw py::error_already_set();
  }
  ~IteratedFrames() override {
    const py::gil_scoped_acquire lock;
    pictures_ = py::object();
  }
  IteratedFrames(const IteratedFrames&) = delete;
  IteratedFrames& operator=(const IteratedFrames&) = delete;
  bool next(cv::Mat& frame) override {
    const py::gil_scoped_acquire lock;
    const auto item = py::reinterpret_steal<py::object>(PyIter_Next(pictures_.ptr()));
    if (!item) {
      if (PyErr_Occurred() != nullptr) throw py::error_already_set();
      return false;
    }
    const cv::Mat picture = picture_of_array(item);
    if (read_ > 0 && picture.size() != size_)
      throw InputError({.file = fmt::format("picture {}", read_), .key = {}},
                       fmt::format("is {} x {} px, but the first picture is {} x {} px", picture.cols,
                                   picture.rows, size_.width, size_.height));
    size_ = picture.size();
    frame = picture;
    ++read_;
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return announced_; }
  [[nodiscard]] std::string current() const override {
    return read_ == 0 ? "pictures" : fmt::format("picture {}", read_ - 1);
  }

 private:
  py::object pictures_;
  std::size_t announced_;
  std::size_t read_ = 0;
  cv::Size size_;
};

py::dict info_of(const imaging::FrameSource& frames) {
  const imaging::StackInfo info = frames.info();
  py::dict d;
  d["format"] = info.format;
  d["bits"] = info.bits;
  d["frame_rate_hz"] = info.frame_rate_hz ? info.frame_rate_hz : info.stamped_rate_hz;
  d["first_number"] = info.first_number;
  d["exposure_s"] = info.exposure_s;
  d["time_origin"] = info.time_origin;
  d["notes"] = info.notes;
  return d;
}

}  // namespace

py::array array_of_picture(const cv::Mat& picture) {
  const auto owner = std::make_shared<cv::Mat>(picture);
  const std::vector<py::ssize_t> shape = {picture.rows, picture.cols};
  const auto row = static_cast<py::ssize_t>(picture.step[0]);
  if (picture.depth() == CV_8U) return view(picture.ptr<std::uint8_t>(), shape, {row, 1}, owner);
  if (picture.depth() == CV_16U) return view(picture.ptr<std::uint16_t>(), shape, {row, 2}, owner);
  return view(picture.ptr<float>(), shape, {row, 4}, owner);
}

cv::Mat picture_of_array(const py::handle& said) {
  if (py::hasattr(said, "filled") && py::bool_(said.attr("mask").attr("any")()))
    throw ConfigError({.file = {}, .key = "picture"},
                      "has masked pixels; give the mask as a picture by the option mask.");
  auto array = py::array::ensure(said);
  if (!array) throw ConfigError({.file = {}, .key = "picture"}, "is no array of numbers.");
  if (array.ndim() != 2 || array.size() == 0) {
    std::string shape;
    for (py::ssize_t k = 0; k < array.ndim(); ++k)
      shape += fmt::format("{}{}", k > 0 ? ", " : "", array.shape(k));
    throw ConfigError({.file = {}, .key = "picture"},
                      fmt::format("has the shape ({}); a picture is (rows, columns) of grey values.", shape));
  }
  const auto as = [&](auto pixel, int type) {
    using Pixel = decltype(pixel);
    const auto dense = py::array_t<Pixel, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!dense) throw ConfigError({.file = {}, .key = "picture"}, "is no array of numbers.");
    const cv::Mat picture(static_cast<int>(dense.shape(0)), static_cast<int>(dense.shape(1)), type,
                          const_cast<Pixel*>(dense.data()));
    return picture.clone();  // the owner of the array may reuse it while other threads read the picture
  };
  const char kind = array.dtype().kind();
  const py::ssize_t size = array.itemsize();
  if (kind == 'b' || (kind == 'u' && size == 1)) return as(std::uint8_t{}, CV_8UC1);
  if (kind == 'u' && size == 2) return as(std::uint16_t{}, CV_16UC1);
  if (kind == 'f') return as(float{}, CV_32FC1);
  throw ConfigError({.file = {}, .key = "picture"},
                    fmt::format("has pixels of type {}; they must be uint8, uint16 or floating point.",
                                py::str(array.dtype()).cast<std::string>()));
}

std::unique_ptr<imaging::FrameSource> source_of(const py::object& stack, std::string& name) {
  const py::object path_type = py::module_::import("os").attr("PathLike");
  if (py::isinstance<py::str>(stack) || py::isinstance(stack, path_type)) {
    name = stack.cast<std::filesystem::path>().string();
    return imaging::open_frames(name);
  }
  name.clear();
  py::object pictures = stack;
  if (py::isinstance<py::array>(stack)) {
    const auto array = stack.cast<py::array>();
    // A picture of 3 or 4 columns has no bead.
    if (array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4))
      throw ConfigError({.file = {}, .key = "stack"},
                        fmt::format("has the shape ({}, {}, {}), which is that of a colour picture; give one "
                                    "channel or the mean of the channels.",
                                    array.shape(0), array.shape(1), array.shape(2)));
    if (array.ndim() == 2) {
      py::list one;
      one.append(stack);
      pictures = one;
    }
  }
  const std::size_t announced = py::hasattr(pictures, "__len__") ? py::len(pictures) : 0;
  return std::make_unique<IteratedFrames>(pictures, announced);
}

py::object stack_of_frames(const py::object& stack, std::string& frames) {
  if (!py::hasattr(stack, "_part_of_stack")) return stack;
  const py::object part = stack.attr("_part_of_stack")(frames);
  if (part.is_none()) return stack;
  frames = part[py::int_(1)].cast<std::string>();
  return part[py::int_(0)];
}

void bind_frames(py::module_& module) {
  py::class_<imaging::FrameSource>(module, "FrameSource",
                                   header_text("imaging/stack/frame_source.hpp", "FrameSource"))
      .def(py::init([](const std::filesystem::path& stack) { return imaging::open_frames(stack); }),
           py::arg("stack"), header_text("imaging/stack/open_frames.hpp", "open_frames"))
      .def(
          "read",
          [](imaging::FrameSource& frames) -> py::object {
            cv::Mat frame;
            const bool read = [&] {
              const py::gil_scoped_release release;
              return frames.next(frame);
            }();
            return read ? py::object(array_of_picture(frame)) : py::none();
          },
          header_text("imaging/stack/frame_source.hpp", "FrameSource::next"))
      .def_property_readonly("announced", &imaging::FrameSource::announced,
                             header_text("imaging/stack/frame_source.hpp", "FrameSource::announced"))
      .def_property_readonly("current", &imaging::FrameSource::current,
                             header_text("imaging/stack/frame_source.hpp", "FrameSource::current"))
      .def_property_readonly("info", &info_of, header_text("imaging/stack/frame_source.hpp", "StackInfo"))
      .def_property_readonly("time_s", &imaging::FrameSource::time_s,
                             header_text("imaging/stack/frame_source.hpp", "FrameSource::time_s"));
}

}  // namespace twincell::python
