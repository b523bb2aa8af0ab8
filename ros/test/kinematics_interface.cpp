// Drives the ros2_control plugin through kinematics_interface::KinematicsInterface, as controllers do.
#include <cmath>
#include <cstdlib>
#include <map>

#include <kinematics_interface/kinematics_interface.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/node.hpp>
#include <urdf_parser/urdf_parser.h>

#include "checks.hpp"
#include "kinematics_interface_kinopt/kinematics_interface_kinopt.hpp"
#include "reference_kinematics.hpp"

#ifdef __SANITIZE_ADDRESS__
#define COUNTS_ALLOCATIONS 0
#else
#define COUNTS_ALLOCATIONS 1

namespace {
bool is_counting = false;
int allocation_count = 0;
} // namespace

// All allocations of the process, those of kinopt included, by the entry points of glibc.
extern "C" {
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size) {
  allocation_count += is_counting;
  return __libc_malloc(size);
}
void *calloc(size_t count, size_t size) {
  allocation_count += is_counting;
  return __libc_calloc(count, size);
}
void *realloc(void *memory, size_t size) {
  allocation_count += is_counting;
  return __libc_realloc(memory, size);
}
void *aligned_alloc(size_t alignment, size_t size) {
  allocation_count += is_counting;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void **memory, size_t alignment, size_t size) {
  allocation_count += is_counting;
  *memory = __libc_memalign(alignment, size);
  return *memory ? 0 : 12;
}
}
#endif

namespace {

using kinematics_interface::KinematicsInterface;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6>;

const double ALPHA = 5e-6;

std::string models;

std::shared_ptr<KinematicsInterface> make_plugin() {
  return pluginlib::stand_in::classes<KinematicsInterface>().at(
      "kinematics_interface_kinopt::KinematicsInterfaceKinopt")();
}

std::shared_ptr<rclcpp::Node> node(const std::map<std::string, rclcpp::Parameter::Value> &parameters) {
  auto node = std::make_shared<rclcpp::Node>();
  for (const auto &[name, value] : parameters) node->declare_parameter(name, value);
  return node;
}

/// A chain of a robot and its plugin.
struct Chain {
  urdf::ModelInterfaceSharedPtr model;
  std::shared_ptr<KinematicsInterface> plugin = make_plugin();
  std::string base;
  std::vector<std::string> joints, links;
  Eigen::VectorXd lower, upper;

  Chain(const std::string &file, const std::string &from, const std::string &to) : base(from) {
    const std::string text = file_text(models + "/" + file);
    model = urdf::parseURDF(text);
    std::vector<std::pair<double, double>> limits;
    links.insert(links.begin(), to);
    for (auto link = model->getLink(to); link->name != base; link = link->getParent()) {
      links.insert(links.begin(), link->getParent()->name);
      if (link->parent_joint->type == urdf::Joint::FIXED) continue;
      joints.insert(joints.begin(), link->parent_joint->name);
      limits.insert(limits.begin(), {link->parent_joint->limits->lower, link->parent_joint->limits->upper});
    }
    lower.resize(static_cast<Eigen::Index>(joints.size()));
    upper.resize(lower.size());
    for (Eigen::Index k = 0; k < lower.size(); ++k) std::tie(lower[k], upper[k]) = limits[static_cast<size_t>(k)];
    CHECK_IN(plugin->initialize(text,
                                node({{"kinematics.tip", to}, {"kinematics.base", from}, {"kinematics.alpha", ALPHA}}),
                                "kinematics"),
             file + ": " + rclcpp::stand_in::last_error);
  }
  Eigen::Index size() const { return lower.size(); }
  Eigen::VectorXd sample(Random &random) const {
    Eigen::VectorXd q(size());
    for (Eigen::Index k = 0; k < size(); ++k) q[k] = random.between(lower[k], upper[k]);
    return q;
  }
  Eigen::Isometry3d pose(const Eigen::VectorXd &q, const std::string &link) const {
    Positions positions;
    for (Eigen::Index k = 0; k < size(); ++k) positions[joints[static_cast<size_t>(k)]] = q[k];
    return base_from_link(*model, base, link, positions);
  }
  /// Motion from one configuration to another, in the base's axes: linear, then angular.
  Vector6 motion(const Eigen::VectorXd &from, const Eigen::VectorXd &to, const std::string &link) const {
    const Eigen::Isometry3d a = pose(from, link), b = pose(to, link);
    const Eigen::AngleAxisd rotation(b.linear() * a.linear().transpose());
    Vector6 motion;
    motion << b.translation() - a.translation(), rotation.angle() * rotation.axis();
    return motion;
  }
};

struct Case {
  const char *file, *base, *tip;
};
const std::vector<Case> CASES = {
    {"franka_panda.urdf", "base", "tool"},          {"franka_panda.urdf", "link1", "link7"},
    {"universal_ur5e.urdf", "base", "flange"},      {"kuka_iiwa14.urdf", "base", "flange"},
    {"rethink_baxter.urdf", "torso", "right_tool"}, {"robotstudio_so101.urdf", "base_link", "gripper_frame_link"},
    {"adept_cobra_s600.urdf", "base", "flange"}};

void initialization() {
  const std::string text = file_text(models + "/franka_panda.urdf");
  const auto is_initialized = [](const std::string &description,
                                 const std::map<std::string, rclcpp::Parameter::Value> &parameters,
                                 const char *prefix) {
    auto plugin = make_plugin();
    const bool initialized = plugin->initialize(description, node(parameters), prefix);
    Eigen::Isometry3d transform;
    CHECK(plugin->calculate_link_transform(Eigen::VectorXd::Zero(7), "link3", transform) == initialized);
    return initialized;
  };
  CHECK(is_initialized(text, {{"tip", "flange"}}, ""));
  CHECK(is_initialized(text, {{"kinematics.tip", "flange"}}, "kinematics"));
  CHECK(is_initialized(text, {{"tip", "flange"}, {"base", ""}}, ""));
  CHECK(is_initialized(text, {{"tip", "flange"}, {"base", "base"}, {"alpha", 0.0}}, ""));
  CHECK(is_initialized("", {{"tip", "flange"}, {"robot_description", text}}, ""));
  CHECK(!is_initialized("", {{"tip", "flange"}}, ""));
  CHECK(!is_initialized(text, {}, ""));
  CHECK(!is_initialized(text, {{"kinematics.tip", "flange"}}, ""));
  CHECK(!is_initialized(text, {{"tip", "elbow"}}, ""));
  CHECK(!is_initialized(text, {{"tip", 7.0}}, ""));
  CHECK(!is_initialized(text, {{"tip", "flange"}, {"base", "elbow"}}, ""));
  CHECK(!is_initialized(text, {{"tip", "flange"}, {"alpha", "small"}}, ""));
  CHECK(!is_initialized(text, {{"tip", "flange"}, {"alpha", -1.0}}, ""));
  CHECK(!is_initialized(text, {{"tip", "link3"}, {"alpha", 0.0}}, ""));
  CHECK(!is_initialized("<robot", {{"tip", "flange"}}, ""));
}

void kinematics() {
  for (const Case &each : CASES) {
    Chain chain(each.file, each.base, each.tip);
    const Eigen::Index n = chain.size();
    Random random;
    for (int k = 0; k < 20; ++k) {
      const Eigen::VectorXd q = chain.sample(random);
      for (const std::string &link : chain.links) {
        const std::string context = std::string(each.file) + " " + link;
        Eigen::Isometry3d transform;
        CHECK_IN(chain.plugin->calculate_link_transform(q, link, transform), context);
        CHECK_IN((transform.matrix() - chain.pose(q, link).matrix()).cwiseAbs().maxCoeff() < 1e-12, context);

        Columns jacobian(6, n);
        CHECK_IN(chain.plugin->calculate_jacobian(q, link, jacobian), context);
        const double step = 1e-6;
        for (Eigen::Index joint = 0; joint < n; ++joint) {
          Eigen::VectorXd ahead = q, behind = q;
          ahead[joint] += step, behind[joint] -= step;
          CHECK_IN((chain.motion(behind, ahead, link) / (2 * step) - jacobian.col(joint)).norm() < 1e-7, context);
        }

        // Joint deltas to Cartesian deltas: the motion of the link, up to second order.
        Eigen::VectorXd joint_deltas(n);
        for (Eigen::Index joint = 0; joint < n; ++joint) joint_deltas[joint] = random.between(-1e-5, 1e-5);
        Vector6 deltas;
        CHECK_IN(chain.plugin->convert_joint_deltas_to_cartesian_deltas(q, joint_deltas, link, deltas), context);
        CHECK_IN((deltas - chain.motion(q, q + joint_deltas, link)).norm() < 1e-8, context);

        // Cartesian deltas to joint deltas: the normal equations of the damped problem.
        Vector6 wanted;
        for (int row = 0; row < 6; ++row) wanted[row] = random.between(-1e-2, 1e-2);
        Eigen::VectorXd found(n);
        CHECK_IN(chain.plugin->convert_cartesian_deltas_to_joint_deltas(q, wanted, link, found), context);
        const Eigen::VectorXd gradient = jacobian.transpose() * (jacobian * found - wanted) + ALPHA * found;
        CHECK_IN(gradient.norm() < 1e-11, context);
        Rows inverse(n, 6);
        CHECK_IN(chain.plugin->calculate_jacobian_inverse(q, link, inverse), context);
        CHECK_IN((inverse * wanted - found).norm() < 1e-12, context);
        // Back again, up to the damping, where six joints or more are far from a singularity.
        const double smallest =
            Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian).singularValues()[std::min<Eigen::Index>(n, 6) - 1];
        if (n >= 6 && smallest > 0.05) {
          CHECK_IN(chain.plugin->convert_joint_deltas_to_cartesian_deltas(q, found, link, deltas), context);
          CHECK_IN((deltas - wanted).norm() <= 1.01 * ALPHA / (smallest * smallest) * wanted.norm(), context);
        }
      }
    }
  }
}

void vectors_of_the_base_class() {
  Chain chain("franka_panda.urdf", "base", "flange");
  std::vector<double> positions = {0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5}; // Far from singularities.
  const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(positions.data(), 7);
  std::vector<double> deltas = {0.01, 0, 0, 0, 0.02, 0}, joint_deltas(7), back(6);
  CHECK(chain.plugin->convert_cartesian_deltas_to_joint_deltas(positions, deltas, "flange", joint_deltas));
  CHECK(chain.plugin->convert_joint_deltas_to_cartesian_deltas(positions, joint_deltas, "flange", back));
  for (size_t k = 0; k < 6; ++k) CHECK(std::abs(back[k] - deltas[k]) < 1e-3);
  Eigen::Isometry3d transform;
  CHECK(chain.plugin->calculate_link_transform(positions, "flange", transform));
  CHECK((transform.matrix() - chain.pose(q, "flange").matrix()).cwiseAbs().maxCoeff() < 1e-12);
  Columns jacobian(6, 7);
  Rows inverse(7, 6);
  CHECK(chain.plugin->calculate_jacobian(positions, "flange", jacobian));
  CHECK(chain.plugin->calculate_jacobian_inverse(positions, "flange", inverse));
  CHECK((jacobian * inverse - Eigen::MatrixXd::Identity(6, 6)).norm() < 1e-1);
}

void wrong_arguments() {
  Chain chain("franka_panda.urdf", "base", "flange");
  KinematicsInterface &plugin = *chain.plugin;
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(7, -0.5), six = Eigen::VectorXd::Zero(6),
                        nan = Eigen::VectorXd::Constant(7, std::nan(""));
  const std::string flange = "flange";
  Eigen::VectorXd joint_deltas(7), short_deltas(6);
  Vector6 deltas = Vector6::Zero();
  Eigen::Isometry3d transform;
  Columns jacobian(6, 7), narrow(6, 6);
  Rows inverse(7, 6), low(6, 6);
  const auto is_refused = [](bool done) {
    const bool refused = !done && rclcpp::stand_in::error_count > 0;
    rclcpp::stand_in::error_count = 0;
    return refused;
  };
  for (const Eigen::VectorXd &wrong : {six, nan}) {
    CHECK(is_refused(plugin.calculate_link_transform(wrong, flange, transform)));
    CHECK(is_refused(plugin.calculate_jacobian(wrong, flange, jacobian)));
    CHECK(is_refused(plugin.calculate_jacobian_inverse(wrong, flange, inverse)));
    CHECK(is_refused(plugin.convert_cartesian_deltas_to_joint_deltas(wrong, deltas, flange, joint_deltas)));
    CHECK(is_refused(plugin.convert_joint_deltas_to_cartesian_deltas(wrong, q, flange, deltas)));
  }
  CHECK(is_refused(plugin.calculate_jacobian(q, flange, narrow)));
  CHECK(is_refused(plugin.calculate_jacobian_inverse(q, flange, low)));
  CHECK(is_refused(plugin.convert_cartesian_deltas_to_joint_deltas(q, deltas, flange, short_deltas)));
  CHECK(is_refused(plugin.convert_joint_deltas_to_cartesian_deltas(q, six, flange, deltas)));
  for (const char *link : {"elbow", "hand", "finger_left", ""}) {
    CHECK(is_refused(plugin.calculate_link_transform(q, link, transform)) == (std::string(link) != "hand"));
  }
  CHECK(is_refused(make_plugin()->calculate_jacobian(q, flange, jacobian)));
}

void frame_difference() {
  kinematics_interface_kinopt::KinematicsInterfaceKinopt plugin;
  Random random;
  Vector6 found;
  Eigen::Matrix<double, 7, 1> a, b;
  for (int k = 0; k < 50; ++k) {
    // A frame that moves at a constant velocity for some time.
    const double dt = random.between(0.01, 0.5);
    Vector6 velocity;
    for (double &each : velocity) each = random.between(-3.0, 3.0);
    const Eigen::Vector3d turn = dt * velocity.tail<3>();
    const Eigen::Quaterniond from =
        Eigen::Quaterniond(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.5)
            .normalized();
    const Eigen::Quaterniond to(Eigen::AngleAxisd(turn.norm(), turn.normalized()) * from);
    a << 0.1, 0.2, 0.3, from.x(), from.y(), from.z(), from.w();
    b << a.head<3>() + dt * velocity.head<3>(), to.x(), to.y(), to.z(), to.w();
    CHECK(plugin.calculate_frame_difference(a, b, dt, found));
    CHECK((found - velocity).norm() < 1e-10);
    b.tail<4>() *= -1.0; // The same rotation.
    CHECK(plugin.calculate_frame_difference(a, b, dt, found));
    CHECK((found - velocity).norm() < 1e-10);
  }
  CHECK(plugin.calculate_frame_difference(a, a, 0.1, found) && found.norm() < 1e-12);
  CHECK(!plugin.calculate_frame_difference(a, b, 0.0, found));
  CHECK(!plugin.calculate_frame_difference(a, b, std::nan(""), found));
}

void no_allocations() {
#if COUNTS_ALLOCATIONS
  for (const Case &each : CASES) {
    Chain chain(each.file, each.base, each.tip);
    const Eigen::Index n = chain.size();
    Random random;
    Eigen::VectorXd q = chain.sample(random), joint_deltas = Eigen::VectorXd::Zero(n);
    Vector6 deltas = Vector6::Constant(0.01);
    Eigen::Isometry3d transform;
    Columns jacobian(6, n);
    Rows inverse(n, 6);
    KinematicsInterface &plugin = *chain.plugin;
    for (const std::string &link : chain.links) {
      allocation_count = 0;
      is_counting = true;
      bool done = plugin.calculate_link_transform(q, link, transform);
      const int after_transform = allocation_count;
      done &= plugin.calculate_jacobian(q, link, jacobian);
      const int after_jacobian = allocation_count;
      done &= plugin.calculate_jacobian_inverse(q, link, inverse);
      done &= plugin.convert_cartesian_deltas_to_joint_deltas(q, deltas, link, joint_deltas);
      done &= plugin.convert_joint_deltas_to_cartesian_deltas(q, joint_deltas, link, deltas);
      is_counting = false;
      CHECK_IN(done && allocation_count == 0,
               std::string(each.file) + " " + link + ": " + std::to_string(after_transform) + ", " +
                   std::to_string(after_jacobian) + ", " + std::to_string(allocation_count));
    }
    // The counter counts: an empty vector of this size is an allocation.
    allocation_count = 0;
    is_counting = true;
    Eigen::VectorXd counted(n);
    is_counting = false;
    CHECK(allocation_count == 1 && counted.size() == n);
  }
#endif
}

} // namespace

int main(int count, char **arguments) {
  models = count > 1 ? arguments[1] : "models";
  const std::vector<std::pair<const char *, void (*)()>> tests = {
      {"initialization", initialization},
      {"kinematics", kinematics},
      {"vectors_of_the_base_class", vectors_of_the_base_class},
      {"wrong_arguments", wrong_arguments},
      {"frame_difference", frame_difference},
      {"no_allocations", no_allocations},
  };
  for (const auto &[name, test] : tests) {
    const int before = failures;
    test();
    std::cout << (failures == before ? "passed " : "FAILED ") << name << std::endl;
  }
  return failures == 0 ? 0 : 1;
}
