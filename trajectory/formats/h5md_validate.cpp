#include <fmt/format.h>

#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"
#include "core/hdf5_self_contained.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/ranges.hpp"

namespace twincell {

namespace {

/// Collects one sentence per fault while walking the file.
class Checker {
 public:
  explicit Checker(hid_t file) : file_(file) {}

  void check_root();
  void check_particles();
  void check_observables();
  void check_connectivity();
  [[nodiscard]] std::vector<std::string> faults() const { return faults_; }

 private:
  void fault(const std::string& where, const std::string& what) { faults_.push_back(where + ": " + what); }
  void check_fixed_string(hid_t object, const std::string& where, const std::string& name, int rank);
  void check_shared(const std::string& element);
  void check_element(const std::string& element);
  std::vector<std::string> children(const std::string& group) const;
  [[nodiscard]] bool same_object(const std::string& a, const std::string& b) const;

  hid_t file_;
  hsize_t frames_ = 0;
  std::string particles_ = "particles/trajectory";
  std::vector<std::string> faults_;
};

std::vector<std::string> Checker::children(const std::string& group) const {
  std::vector<std::string> names;
  const h5::Handle g = h5::own(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), "opening " + group);
  auto visit = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  H5Literate(g.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names);
  return names;
}

bool Checker::same_object(const std::string& a, const std::string& b) const {
  H5O_info_t x{}, y{};
  if (H5Oget_info_by_name2(file_, a.c_str(), &x, H5O_INFO_BASIC, H5P_DEFAULT) < 0) return false;
  if (H5Oget_info_by_name2(file_, b.c_str(), &y, H5O_INFO_BASIC, H5P_DEFAULT) < 0) return false;
  return x.addr == y.addr && x.fileno == y.fileno;
}

void Checker::check_fixed_string(hid_t object, const std::string& where, const std::string& name, int rank) {
  if (H5Aexists(object, name.c_str()) <= 0) return fault(where + "@" + name, "the attribute is missing.");
  const h5::Handle attribute =
      h5::own(H5Aopen(object, name.c_str(), H5P_DEFAULT), "opening attribute " + name);
  const h5::Handle type = h5::own(H5Aget_type(attribute.get()), "reading a type");
  const h5::Handle space = h5::own(H5Aget_space(attribute.get()), "reading a space");
  if (H5Tget_class(type.get()) != H5T_STRING)
    fault(where + "@" + name, "a string is needed.");
  else if (H5Tis_variable_str(type.get()) > 0)
    fault(where + "@" + name, "the string must be of fixed length.");
  if (H5Sget_simple_extent_ndims(space.get()) != rank)
    fault(where + "@" + name, fmt::format("the attribute must have rank {}.", rank));
}

void Checker::check_root() {
  if (!h5::exists(file_, "h5md")) return fault("h5md", "the group is missing.");
  const h5::Handle h5md = h5::own(H5Oopen(file_, "h5md", H5P_DEFAULT), "opening h5md");
  const auto version = h5::read_int_attribute(h5md.get(), "version");
  if (version != std::vector<int>{1, 0} && version != std::vector<int>{1, 1})
    fault("h5md@version", "must be [1, 0] or [1, 1].");
  for (const auto& [group, attributes] :
       {std::pair<std::string, std::vector<std::string>>{"h5md/author", {"name"}},
        {"h5md/creator", {"name", "version"}}}) {
    if (!h5::exists(file_, group)) {
      fault(group, "the group is missing.");
      continue;
    }
    const h5::Handle g = h5::own(H5Oopen(file_, group.c_str(), H5P_DEFAULT), "opening " + group);
    for (const auto& name : attributes) check_fixed_string(g.get(), group, name, 0);
  }
}

void Checker::check_shared(const std::string& element) {
  for (const char* name : {"step", "time"}) {
    const std::string here = element + "/" + name;
    if (!h5::exists(file_, here))
      fault(here, "the dataset is missing.");
    else if (!same_object(here, particles_ + "/position/" + name))
      fault(here, std::string("must be a hard link to position/") + name + ".");
  }
}

void Checker::check_element(const std::string& element) {
  const std::string value = element + "/value";
  const h5::Series series(file_, value);
  if (!series) return fault(value, "the dataset is missing.");
  if (series.size() != frames_)
    fault(value, fmt::format("{} frames, position has {}.", series.size(), frames_));
  check_shared(element);
}

void Checker::check_particles() {
  // Group: readers take the first one by name, which must be `trajectory`.
  if (!h5::exists(file_, "particles")) return fault("particles", "the group is missing.");
  const auto groups = children("particles");
  if (groups.empty()) return fault("particles", "the group is empty.");
  if (!h5::exists(file_, particles_)) {
    fault("particles", "has no group 'trajectory'.");
    particles_ = "particles/" + groups.front();
  } else if (groups.front() != "trajectory") {
    fault("particles/" + groups.front(), "sorts before 'trajectory'; readers take the first group.");
  }
  // Position: its number of frames and beads is the reference for all other elements.
  const std::string position = particles_ + "/position";
  for (const char* name : {"step", "time", "value"})
    if (!h5::exists(file_, position + "/" + name))
      return fault(position + "/" + name, "the dataset is missing.");
  const h5::Series value(file_, position + "/value");
  frames_ = value.size();
  if (value.record().size() != 2 || value.record()[1] != 3)
    return fault(position + "/value", "must be frames x beads x 3.");
  const auto steps = h5::read_dataset<std::int64_t>(file_, position + "/step");
  if (steps.size() != frames_)
    fault(position + "/step", fmt::format("{} steps for {} frames.", steps.size(), frames_));
  for (std::size_t i = 1; i < steps.size(); ++i)
    if (steps[i] <= steps[i - 1]) {
      fault(position + "/step", fmt::format("does not increase at frame {}.", i));
      break;
    }
  // Other elements: groups have one record per frame, datasets one entry per bead.
  for (const auto& name : children(particles_)) {
    const std::string element = particles_ + "/" + name;
    if (name == "position" || name == "box") continue;
    const h5::Handle object = h5::own(H5Oopen(file_, element.c_str(), H5P_DEFAULT), "opening " + element);
    if (H5Iget_type(object.get()) == H5I_GROUP) {
      check_element(element);
      const h5::Series column(file_, element + "/value");
      if (column && (column.record().empty() || column.record()[0] != value.record()[0]))
        fault(element + "/value", "its number of beads differs from position's.");
    } else {
      const auto shape = h5::extents(object.get());
      if (shape.empty() || shape[0] != value.record()[0])
        fault(element, "a time-independent element needs one entry per bead.");
    }
  }
  // Box: H5MD requires dimension and boundary as attributes.
  const std::string box = particles_ + "/box";
  if (!h5::exists(file_, box)) return fault(box, "the group is missing.");
  const h5::Handle b = h5::own(H5Oopen(file_, box.c_str(), H5P_DEFAULT), "opening the box");
  if (h5::read_int_attribute(b.get(), "dimension") != std::vector<int>{3})
    fault(box + "@dimension", "must be 3.");
  check_fixed_string(b.get(), box, "boundary", 1);
  const auto words = h5::read_text_attribute(b.get(), "boundary");
  if (words.size() != 3) fault(box + "@boundary", "must have three entries.");
  for (const auto& word : words)
    if (word != "none" && word != "periodic")
      fault(box + "@boundary", "'" + word + "' is neither none nor periodic.");
  if (h5::exists(file_, box + "/edges/value")) check_element(box + "/edges");
}

void Checker::check_observables() {
  if (!h5::exists(file_, "observables")) return;
  for (const auto& name : children("observables")) {
    const std::string element = "observables/" + name;
    const h5::Handle object = h5::own(H5Oopen(file_, element.c_str(), H5P_DEFAULT), "opening " + element);
    if (H5Iget_type(object.get()) != H5I_GROUP)
      fault(element, "observables must be groups with value, step and time.");
    else
      check_element(element);
  }
}

void Checker::check_connectivity() {
  const std::string element = "connectivity/contacts";
  if (!h5::exists(file_, element)) return;
  check_element(element);
  const h5::Handle group = h5::own(H5Oopen(file_, element.c_str(), H5P_DEFAULT), "opening " + element);
  if (H5Aexists(group.get(), "particles_group") <= 0)
    fault(element + "@particles_group", "the attribute is missing.");
}

}  // namespace

std::vector<std::string> validate_h5md(const std::filesystem::path& path) {
  std::vector<std::string> faults;
  {
    const h5::Handle file = h5::open_file(path);
    if (!file || !h5::data_elsewhere(file.get()).empty())
      H5mdReader give_the_reason(path);  // throws InputError
    try {
      Checker checker(file.get());
      checker.check_root();
      checker.check_particles();
      checker.check_observables();
      checker.check_connectivity();
      faults = checker.faults();
    } catch (const RunError& e) {
      faults.emplace_back(e.what());
    }
  }
  if (!faults.empty()) return faults;
  // The structure is valid. Check the content: every frame is readable and in the ranges that the reader
  // requires.
  const H5mdReader reader(path);
  Frame frame;
  for (std::size_t f = 0; f < reader.n_frames(); ++f) {
    try {
      reader.read(f, frame);
      require_filled_slots(frame, f, path.string());
    } catch (const InputError& e) {
      faults.emplace_back(e.what());
      return faults;
    }
  }
  return faults;
}

}  // namespace twincell
