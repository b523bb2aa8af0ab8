// ros2_control kinematics interface over kinopt. Licence: MIT or Apache-2.0.
#include "kinematics_interface_kinopt/kinematics_interface_kinopt.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/parameter.hpp>

namespace kinematics_interface_kinopt {
namespace {

/// Default of the parameter `alpha`, as in kinematics_interface_kdl.
constexpr double DEFAULT_ALPHA = 0.000005;

rclcpp::Logger logger() { return rclcpp::get_logger("kinematics_interface_kinopt"); }

std::optional<rclcpp::Parameter> parameter(rclcpp::node_interfaces::NodeParametersInterface &node,
                                           const std::string &name) {
  rclcpp::Parameter value;
  if (!node.has_parameter(name) || !node.get_parameter(name, value)) return std::nullopt;
  return value;
}

} // namespace

bool KinematicsInterfaceKinopt::initialize(
    const std::string &robot_description,
    std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> parameters_interface,
    const std::string &param_namespace) {
  links_.clear();
  const std::string prefix = param_namespace.empty() ? "" : param_namespace + ".";
  try {
    std::string description = robot_description;
    if (description.empty()) {
      const auto given = parameter(*parameters_interface, "robot_description");
      if (!given) throw std::invalid_argument("parameter `robot_description` is not set");
      description = given->as_string();
    }
    const auto tip = parameter(*parameters_interface, prefix + "tip");
    if (!tip) throw std::invalid_argument("parameter `" + prefix + "tip` is not set");
    const auto base = parameter(*parameters_interface, prefix + "base");
    const auto alpha = parameter(*parameters_interface, prefix + "alpha");
    alpha_ = alpha ? alpha->as_double() : DEFAULT_ALPHA;
    if (!(alpha_ >= 0.0 && std::isfinite(alpha_))) throw std::invalid_argument("`alpha` must be at least 0");

    const kinopt::Robot robot =
        kinopt::Robot::parse(description, "robot_description", kinopt::Settings().set("lenient", true));
    // An empty base is the world, which is the root link.
    const std::string base_name = base ? base->as_string() : "", tip_name = tip->as_string();
    const std::vector<std::string> joints =
        kinopt::Arm(robot, base_name, tip_name, kinopt::Settings().set("atlas", false)).joint_names();
    joint_count_ = static_cast<Eigen::Index>(joints.size());
    if (alpha_ == 0.0 && joint_count_ < 6) {
      throw std::invalid_argument("`alpha` must be above 0 for a chain of fewer than 6 joints");
    }
    for (const std::string &name : robot.frame_names()) {
      try {
        links_.emplace(name, kinopt::ArmLink(robot, base_name, tip_name, name));
      } catch (const kinopt::Error &) { // Not in the chain.
      }
    }
    std::string names;
    for (const std::string &name : joints) names += " " + name;
    RCLCPP_INFO(logger(), "kinopt %s has the chain from '%s' to '%s', joints:%s", kinopt_version(),
                base_name.empty() ? "the root link" : base_name.c_str(), tip_name.c_str(), names.c_str());
  } catch (const std::exception &error) { // Of kinopt, or a parameter of another type.
    links_.clear();
    RCLCPP_ERROR(logger(), "%s", error.what());
    return false;
  }
  jacobian_.setZero(6, joint_count_);
  inverse_.setZero(joint_count_, 6);
  return true;
}

kinopt::ArmLink *KinematicsInterfaceKinopt::link(const std::string &name) {
  if (links_.empty()) {
    RCLCPP_ERROR(logger(), "The plugin is not initialized");
    return nullptr;
  }
  const auto found = links_.find(name);
  if (found != links_.end()) return &found->second;
  std::string known;
  for (const auto &each : links_) known += " " + each.first;
  RCLCPP_ERROR(logger(), "Link '%s' is not in the chain. Its links are:%s", name.c_str(), known.c_str());
  return nullptr;
}

bool KinematicsInterfaceKinopt::has_joint_size(Eigen::Index size, const char *what) const {
  if (size == joint_count_) return true;
  RCLCPP_ERROR(logger(), "The %s has size %zd, expected %zd", what, size, joint_count_);
  return false;
}

bool KinematicsInterfaceKinopt::update_jacobian(const Eigen::VectorXd &joint_pos, const std::string &link_name) {
  kinopt::ArmLink *found = link(link_name);
  if (!found || !has_joint_size(joint_pos.size(), "vector of joint positions")) return false;
  try {
    found->jacobian(joint_pos, jacobian_);
  } catch (const kinopt::Error &error) { // Joint positions that are not finite.
    RCLCPP_ERROR(logger(), "%s", error.what());
    return false;
  }
  return true;
}

void KinematicsInterfaceKinopt::update_inverse() {
  Eigen::Matrix<double, 6, 6> damped;
  damped.noalias() = jacobian_ * jacobian_.transpose();
  damped.diagonal().array() += alpha_;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factors(damped);
  const Eigen::Matrix<double, 6, 6> inverse = factors.solve(Eigen::Matrix<double, 6, 6>::Identity());
  inverse_.noalias() = jacobian_.transpose() * inverse;
}

bool KinematicsInterfaceKinopt::convert_cartesian_deltas_to_joint_deltas(const Eigen::VectorXd &joint_pos,
                                                                         const Eigen::Matrix<double, 6, 1> &delta_x,
                                                                         const std::string &link_name,
                                                                         Eigen::VectorXd &delta_theta) {
  if (!has_joint_size(delta_theta.size(), "vector of joint deltas")) return false;
  if (!update_jacobian(joint_pos, link_name)) return false;
  update_inverse();
  delta_theta.noalias() = inverse_ * delta_x;
  return true;
}

bool KinematicsInterfaceKinopt::convert_joint_deltas_to_cartesian_deltas(const Eigen::VectorXd &joint_pos,
                                                                         const Eigen::VectorXd &delta_theta,
                                                                         const std::string &link_name,
                                                                         Eigen::Matrix<double, 6, 1> &delta_x) {
  if (!has_joint_size(delta_theta.size(), "vector of joint deltas")) return false;
  if (!update_jacobian(joint_pos, link_name)) return false;
  delta_x.noalias() = jacobian_ * delta_theta;
  return true;
}

bool KinematicsInterfaceKinopt::calculate_link_transform(const Eigen::VectorXd &joint_pos, const std::string &link_name,
                                                         Eigen::Isometry3d &transform) {
  const kinopt::ArmLink *found = link(link_name);
  if (!found || !has_joint_size(joint_pos.size(), "vector of joint positions")) return false;
  try {
    transform = found->base_from_link(joint_pos);
  } catch (const kinopt::Error &error) { // Joint positions that are not finite.
    RCLCPP_ERROR(logger(), "%s", error.what());
    return false;
  }
  return true;
}

bool KinematicsInterfaceKinopt::calculate_jacobian(const Eigen::VectorXd &joint_pos, const std::string &link_name,
                                                   Eigen::Matrix<double, 6, Eigen::Dynamic> &jacobian) {
  if (!has_joint_size(jacobian.cols(), "Jacobian")) return false;
  if (!update_jacobian(joint_pos, link_name)) return false;
  jacobian = jacobian_;
  return true;
}

bool KinematicsInterfaceKinopt::calculate_jacobian_inverse(const Eigen::VectorXd &joint_pos,
                                                           const std::string &link_name,
                                                           Eigen::Matrix<double, Eigen::Dynamic, 6> &jacobian_inverse) {
  if (!has_joint_size(jacobian_inverse.rows(), "inverse Jacobian")) return false;
  if (!update_jacobian(joint_pos, link_name)) return false;
  update_inverse();
  jacobian_inverse = inverse_;
  return true;
}

bool KinematicsInterfaceKinopt::calculate_frame_difference(Eigen::Matrix<double, 7, 1> &x_a,
                                                           Eigen::Matrix<double, 7, 1> &x_b, double dt,
                                                           Eigen::Matrix<double, 6, 1> &delta_x) {
  if (!(dt > 0.0)) {
    RCLCPP_ERROR(logger(), "The period is %g s, expected more than 0", dt);
    return false;
  }
  const Eigen::Quaterniond a = Eigen::Quaterniond(x_a[6], x_a[3], x_a[4], x_a[5]).normalized();
  const Eigen::Quaterniond b = Eigen::Quaterniond(x_b[6], x_b[3], x_b[4], x_b[5]).normalized();
  const Eigen::AngleAxisd rotation(b * a.conjugate());
  delta_x.head<3>() = (x_b.head<3>() - x_a.head<3>()) / dt;
  delta_x.tail<3>() = rotation.angle() / dt * rotation.axis();
  return true;
}

} // namespace kinematics_interface_kinopt

PLUGINLIB_EXPORT_CLASS(kinematics_interface_kinopt::KinematicsInterfaceKinopt,
                       kinematics_interface::KinematicsInterface)
