// Trajectories in Python: columns as NumPy arrays without a copy, made from arrays, opened and written.

#include "python/trajectory.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "python/box.hpp"
#include "trajectory/foreign/format.hpp"

namespace twincell::python {

namespace {

FileIdentity identity_of(const std::filesystem::path& file) {
  const auto found = FileIdentity::of(file);
  if (!found) throw InputError({.file = file.string(), .key = {}}, "the file cannot be read.");
  return *found;
}

}  // namespace

Trajectory::Trajectory(const std::filesystem::path& file)
    : source_(std::make_unique<H5mdReader>(file)),
      file_({std::filesystem::absolute(file), identity_of(file)}) {}

std::optional<Trajectory::File> Trajectory::file() const {
  return file_ && FileIdentity::of(file_->path) == file_->identity ? file_ : std::nullopt;
}

std::shared_ptr<const Frame> Trajectory::frame(std::size_t index) {
  if (memory_ != nullptr) return memory_->frames()[index];
  if (last_ == nullptr || last_index_ != index) {
    auto read = std::make_shared<Frame>();
    source_->read(index, *read);
    last_ = std::move(read);
    last_index_ = index;
  }
  return last_;
}

void require_no_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code none;  // a file that is not there is no input
    if (std::filesystem::equivalent(output, input, none))
      throw ConfigError({.file = output.string(), .key = {}}, "the output is an input of the same call.");
  }
}

namespace {

/// The function that makes a trajectory of a file or folder that is none; empty: none does.
std::string advice_on_kind(const std::filesystem::path& path) {
  std::error_code none;
  const std::string extension = path.extension().string();
  const auto of = [&](const char* call, const std::string& options, const char* kind) {
    return fmt::format("{}(\"{}\"{}) makes a trajectory of {}", call, path.string(), options, kind);
  };
  if (std::filesystem::is_directory(path, none)) return of("track", "", "a stack of frames");
  if (!std::filesystem::exists(path, none)) return {};
  if (extension == ".toml") return of("simulate", "", "a scene");
  if (format_of_extension(extension) == nullptr) return {};
  return of("import_", fmt::format(", output=\"{}.h5\"", path.stem().string()), "a file of another program");
}

}  // namespace

std::shared_ptr<Trajectory> open_trajectory(const std::filesystem::path& path) {
  try {
    return std::make_shared<Trajectory>(path);
  } catch (const InputError& e) {
    const std::string advice = advice_on_kind(path);
    if (advice.empty()) throw;
    throw InputError({}, fmt::format("{}; {}.", without_full_stop(e.what()), advice));
  }
}

std::shared_ptr<Trajectory> trajectory_of(const py::handle& said) {
  if (py::isinstance<Trajectory>(said)) return said.cast<std::shared_ptr<Trajectory>>();
  if (!py::isinstance<py::str>(said) && !py::hasattr(said, "__fspath__"))
    throw py::type_error(fmt::format("a Trajectory or the name of its file is needed, not {}",
                                     py::str(py::type::of(said).attr("__name__")).cast<std::string>()));
  return open_trajectory(said.cast<std::filesystem::path>());
}

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

constexpr const char* kHeader = "trajectory/trajectory.hpp";

std::size_t index_of(py::ssize_t i, std::size_t n) {
  const auto length = static_cast<py::ssize_t>(n);
  if (i < -length || i >= length)
    throw py::index_error(fmt::format("frame {} does not exist; the trajectory has {} frames.", i, n));
  return static_cast<std::size_t>(i < 0 ? i + length : i);
}

/// A per-bead vector of every frame: column[t] is an array (n_beads, 3) without a copy.
struct Column {
  std::shared_ptr<Trajectory> trajectory;
  std::vector<Vec3> Frame::*member;

  [[nodiscard]] py::array at(std::size_t t) const {
    const auto frame = trajectory->frame(t);
    const std::vector<Vec3>& values = (*frame).*member;
    return view(reinterpret_cast<const double*>(values.data()), {static_cast<py::ssize_t>(values.size()), 3},
                {sizeof(Vec3), sizeof(double)}, frame);
  }
  [[nodiscard]] py::array stack(std::size_t start, py::ssize_t step, std::size_t length) const {
    const std::size_t n = trajectory->info().n_beads;
    std::vector<double> all;
    all.reserve(length * n * 3);
    for (std::size_t k = 0; k < length; ++k) {
      const auto frame = trajectory->frame(
          static_cast<std::size_t>(static_cast<py::ssize_t>(start) + static_cast<py::ssize_t>(k) * step));
      for (const Vec3& v : (*frame).*member) all.insert(all.end(), v.data(), v.data() + 3);
    }
    return array_of(std::move(all), {static_cast<py::ssize_t>(length), static_cast<py::ssize_t>(n), 3});
  }
};

/// The type of an array over contacts; its fields are the members of ContactForce.
py::dtype contact_dtype() {
  const ContactForce c;
  py::list names, formats, offsets;
  const auto field = [&](const char* name, const char* format, const auto& member) {
    names.append(name);
    formats.append(format);
    offsets.append(reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&c));
  };
  field("i", "i4", c.i);
  field("j", "i4", c.j);
  field("overlap", "f8", c.overlap);
  field("normal", "(3,)f8", c.normal);
  field("normal_force", "f8", c.normal_force);
  field("tangential_force", "(3,)f8", c.tangential_force);
  return {names, formats, offsets, sizeof(ContactForce)};
}

/// The contacts of every frame: contacts[t] is a structured array without a copy.
struct Contacts {
  std::shared_ptr<Trajectory> trajectory;

  [[nodiscard]] py::array at(std::size_t t) const {
    const auto frame = trajectory->frame(t);
    const std::vector<ContactForce>& values = frame->contact_forces;
    return view(values.data(), contact_dtype(), {static_cast<py::ssize_t>(values.size())},
                {sizeof(ContactForce)}, frame);
  }
};

/// Number of every frame, from a pass over the file.
template <class Value>
py::array of_frames(Trajectory& trajectory, Value value) {
  std::vector<decltype(value(Frame{}))> values;
  values.reserve(trajectory.n_frames());
  for (std::size_t t = 0; t < trajectory.n_frames(); ++t) values.push_back(value(*trajectory.frame(t)));
  py::array array = array_of(std::move(values));
  array.attr("setflags")(py::arg("write") = false);  // it is a copy, in which a change would be lost
  return array;
}

template <class T>
py::object of_slots(const std::shared_ptr<Trajectory>& trajectory, const std::vector<T>& values) {
  if (values.empty()) return py::none();
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, trajectory);
}

/// A folder for temporary files; the caller calls its cleanup().
py::object temporary_folder() {
  return py::module_::import("tempfile").attr("TemporaryDirectory")();
}
std::filesystem::path file_in(const py::object& folder) {
  return std::filesystem::path(folder.attr("name").cast<std::string>()) / "trajectory.h5";
}

void write(Trajectory& trajectory, const std::filesystem::path& path) {
  require_no_input(path, {trajectory.source().name()});
  H5mdWriter writer(path, trajectory.info());
  for (std::size_t t = 0; t < trajectory.n_frames(); ++t) writer.append(*trajectory.frame(t));
  writer.finish();
}

/// State for pickle: of a file its absolute path, its size and its time of modification; in memory the
/// bytes of its H5MD file.
py::tuple pickled(Trajectory& trajectory) {
  if (const auto file = trajectory.file())
    return py::make_tuple(file->path.string(), file->identity.bytes, file->identity.modified_ns);
  const py::object folder = temporary_folder();
  write(trajectory, file_in(folder));
  const py::object bytes =
      py::module_::import("pathlib").attr("Path")(file_in(folder).string()).attr("read_bytes")();
  folder.attr("cleanup")();
  return py::make_tuple(bytes);
}
std::shared_ptr<Trajectory> unpickled(const py::tuple& state) {
  if (py::isinstance<py::str>(state[0])) {
    const std::filesystem::path path(state[0].cast<std::string>());
    if (state.size() > 2)
      if (const FileIdentity id = identity_of(path);
          id.bytes != state[1].cast<std::uint64_t>() || id.modified_ns != state[2].cast<std::int64_t>())
        throw InputError({.file = path.string(), .key = {}},
                         "the file was replaced or changed since the trajectory was pickled.");
    return std::make_shared<Trajectory>(path);
  }
  const py::object folder = temporary_folder();
  py::module_::import("pathlib").attr("Path")(file_in(folder).string()).attr("write_bytes")(state[0]);
  std::optional<SharedFrames> frames;
  {
    const H5mdReader file(file_in(folder));
    frames.emplace(file.info());
    Frame frame;
    for (std::size_t k = 0; k < file.n_frames(); ++k) file.read(k, frame), frames->append(frame);
  }
  folder.attr("cleanup")();
  return std::make_shared<Trajectory>(std::move(*frames));
}

/// \param of_bead text of the column of one frame
std::string of_frame_text(const std::string& what, const std::string& of_bead) {
  return "Column of frames, `column[t]`: an array (n_beads, 3) with " + what +
         " of every slot in frame t; None if the trajectory has no such column. In C++: " + of_bead;
}

void bind_column(py::module_& module) {
  py::class_<Column>(
      module, "Column",
      "A vector per bead in every frame: column[t] is a read-only array (n_beads, 3) over the memory of the "
      "frame, column[a:b], column[a:b, i] and numpy.asarray(column) are copies of (frames, n_beads, 3).")
      .def("__len__", [](const Column& c) { return c.trajectory->n_frames(); })
      .def(
          "__getitem__",
          [](const Column& c, py::ssize_t t) { return c.at(index_of(t, c.trajectory->n_frames())); },
          py::arg("frame"))
      .def(
          "__getitem__",
          [](const Column& c, const py::slice& slice) {
            std::size_t start = 0, stop = 0, step = 0, length = 0;
            if (!slice.compute(c.trajectory->n_frames(), &start, &stop, &step, &length))
              throw py::error_already_set();
            return c.stack(start, static_cast<py::ssize_t>(step), length);
          },
          py::arg("frames"))
      .def(
          "__getitem__",
          [](const Column& c, const py::tuple& key) -> py::object {
            return c.stack(0, 1, c.trajectory->n_frames())[key];
          },
          py::arg("key"))
      .def(
          "__array__",
          [](const Column& c, const py::object& dtype) -> py::object {
            const py::array all = c.stack(0, 1, c.trajectory->n_frames());
            return dtype.is_none() ? py::object(all) : all.attr("astype")(dtype);
          },
          py::arg("dtype") = py::none());
}

void bind_contacts(py::module_& module) {
  py::class_<Contacts>(
      module, "Contacts",
      "The contacts of every frame: contacts[t] is a read-only structured array over the memory of the "
      "frame, sorted by (i, j), with the fields i, j, overlap, normal (3), normal_force and tangential_force "
      "(3).")
      .def("__len__", [](const Contacts& c) { return c.trajectory->n_frames(); })
      .def(
          "__getitem__",
          [](const Contacts& c, py::ssize_t t) { return c.at(index_of(t, c.trajectory->n_frames())); },
          py::arg("frame"), header_text(kHeader, "ContactForce"));
}

using TrajectoryClass = py::class_<Trajectory, std::shared_ptr<Trajectory>>;

void bind_making(TrajectoryClass& bound) {
  bound
      .def_static("open", &open_trajectory, py::arg("path"),
                  header_text("trajectory/formats/h5md_file.hpp", "H5mdReader"))
      .def("write", &write, py::arg("path"), header_text("trajectory/formats/h5md_file.hpp", "H5mdWriter"));
}

/// The columns of the beads.
void bind_bead_columns(TrajectoryClass& bound) {
  const auto column = [](bool Columns::*has, std::vector<Vec3> Frame::*member) {
    return [has, member](const std::shared_ptr<Trajectory>& t) -> py::object {
      if (has != nullptr && !(t->info().columns.*has)) return py::none();
      return py::cast(Column{t, member});
    };
  };
  bound
      .def_property_readonly("positions", column(nullptr, &Frame::position),
                             of_frame_text("x, y, z", header_text(kHeader, "Frame::position")).c_str())
      .def_property_readonly("velocities", column(&Columns::velocity, &Frame::velocity),
                             of_frame_text("the velocity", header_text(kHeader, "Frame::velocity")).c_str())
      .def_property_readonly("spins", column(&Columns::spin, &Frame::spin),
                             of_frame_text("the spin", header_text(kHeader, "Frame::spin")).c_str())
      .def_property_readonly(
          "position_sigma", column(&Columns::position_sigma, &Frame::position_sigma),
          of_frame_text("the uncertainty of x, y, z", header_text(kHeader, "Frame::position_sigma")).c_str())
      .def_property_readonly(
          "contacts",
          [](const std::shared_ptr<Trajectory>& t) -> py::object {
            if (!t->info().columns.contact_forces) return py::none();
            return py::cast(Contacts{t});
          },
          "Contacts: contacts[t] has those of frame t with their forces. None if the trajectory does not "
          "store them (simulate --contacts, the key time.contacts).");
}

/// The walls, and the numbers of each bead that are the same in all frames.
void bind_bead_numbers(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "walls", [](const Trajectory& t) { return t.info().walls; },
          header_text(kHeader, "TrajectoryInfo::walls"))
      .def_property_readonly(
          "radii", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().radius); },
          header_text(kHeader, "TrajectoryInfo::radius"))
      .def_property_readonly(
          "masses", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().mass); },
          header_text(kHeader, "TrajectoryInfo::mass"))
      .def_property_readonly(
          "tracers", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().tracer); },
          header_text(kHeader, "TrajectoryInfo::tracer"));
}

/// The numbers of each frame.
void bind_frame_columns(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "step", [](Trajectory& t) { return of_frames(t, [](const Frame& f) { return f.step; }); },
          header_text(kHeader, "Frame::step"))
      .def_property_readonly(
          "time", [](Trajectory& t) { return of_frames(t, [](const Frame& f) { return f.time; }); },
          header_text(kHeader, "Frame::time"))
      .def_property_readonly(
          "phase",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.phase) return py::none();
            return of_frames(t, [](const Frame& f) { return f.phase; });
          },
          header_text(kHeader, "Frame::phase"))
      .def_property_readonly(
          "cycle",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.phase) return py::none();
            return of_frames(t, [](const Frame& f) { return f.cycle; });
          },
          header_text(kHeader, "Frame::cycle"))
      .def_property_readonly(
          "plate_height",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.plate_height) return py::none();
            return of_frames(t, [](const Frame& f) { return f.plate_height; });
          },
          header_text(kHeader, "Frame::plate_height"));
}

/// What the trajectory states of its cell, drive and origin.
void bind_info(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "box", [](const Trajectory& t) { return t.info().box; }, header_text("trajectory/box.hpp", "Box"))
      .def_property_readonly(
          "drive", [](const Trajectory& t) { return t.info().drive; },
          header_text("trajectory/drive.hpp", "Drive"))
      .def_property_readonly(
          "phases_per_cycle", [](const Trajectory& t) { return t.info().phases_per_cycle; },
          header_text(kHeader, "TrajectoryInfo::phases_per_cycle"))
      .def_property_readonly(
          "source", [](const Trajectory& t) { return std::string(word_of(t.info().source)); },
          header_text(kHeader, "Origin"))
      .def_property_readonly(
          "scale",
          [](const Trajectory& t) {
            py::dict d;
            d["sigma_m"] = t.info().scale.sigma_m;
            d["gravity_m_s2"] = t.info().scale.gravity_m_s2;
            d["pixels_per_sigma"] = t.info().scale.pixels_per_sigma;
            d["t0_s"] = t.info().scale.t0_s();
            return d;
          },
          header_text("trajectory/units.hpp", "Scale"))
      .def_property_readonly(
          "provenance",
          [](const Trajectory& t) {
            return t.info().provenance_json.empty() ? py::object(py::none())
                                                    : from_json(t.info().provenance_json);
          },
          "What produced the trajectory, as a dict; None if the file does not say.")
      .def_property_readonly(
          "tracking",
          [](const Trajectory& t) {
            return t.info().tracking_json.empty() ? py::object(py::none())
                                                  : from_json(t.info().tracking_json);
          },
          header_text(kHeader, "TrajectoryInfo::tracking_json"));
}

}  // namespace

void bind_trajectory(py::module_& module) {
  bind_box(module);
  bind_drive(module);
  bind_column(module);
  bind_contacts(module);
  TrajectoryClass bound(module, "Trajectory", header_text(kHeader, "TrajectorySource"));
  bind_making(bound);
  bound.def("__len__", &Trajectory::n_frames)
      .def_property_readonly("n_frames", &Trajectory::n_frames, "Number of frames.")
      .def_property_readonly(
          "n_beads", [](const Trajectory& t) { return t.info().n_beads; },
          "Number of slots: slot i is the same bead in every frame.")
      .def_property_readonly(
          "name", [](const Trajectory& t) { return t.source().name(); }, "The file, or \"memory\".")
      .def_property_readonly("_file", [](const Trajectory& t) {
        const auto file = t.file();
        return file ? std::optional(file->path) : std::nullopt;
      });
  bind_bead_columns(bound);
  bind_bead_numbers(bound);
  bind_frame_columns(bound);
  bind_info(bound);
  bound.def(py::pickle(&pickled, &unpickled)).def("__repr__", [](const Trajectory& t) {
    return fmt::format("<twincell.Trajectory of {}: {} frames of {} beads, {}>", t.source().name(),
                       t.n_frames(), t.info().n_beads, word_of(t.info().source));
  });
}

}  // namespace twincell::python
