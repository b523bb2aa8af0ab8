// ros2_control kinematics interface over kinopt. Licence: MIT or Apache-2.0.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include <kinematics_interface/kinematics_interface.hpp>
#include <kinopt/kinopt.hpp>

namespace kinematics_interface_kinopt {

/// Kinematics of the chain from the parameter `base` to the parameter `tip`, for control loops.
///
/// Joint vectors have one value for each moving joint of the chain, from base to tip, in radians and metres. Links are
/// those of the chain. Placements, Jacobians and deltas are in the axes of the base. Deltas belong to the origin of the
/// link. Outputs must have their size. After initialize(), successful calls allocate nothing. One thread at a time uses
/// an object.
class KinematicsInterfaceKinopt : public kinematics_interface::KinematicsInterface {
public:
  bool initialize(const std::string &robot_description,
                  std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> parameters_interface,
                  const std::string &param_namespace) override;

  /// Damped least squares: Jᵀ (J Jᵀ + alpha I)⁻¹ delta_x.
  bool convert_cartesian_deltas_to_joint_deltas(const Eigen::VectorXd &joint_pos,
                                                const Eigen::Matrix<double, 6, 1> &delta_x,
                                                const std::string &link_name, Eigen::VectorXd &delta_theta) override;

  bool convert_joint_deltas_to_cartesian_deltas(const Eigen::VectorXd &joint_pos, const Eigen::VectorXd &delta_theta,
                                                const std::string &link_name,
                                                Eigen::Matrix<double, 6, 1> &delta_x) override;

  bool calculate_link_transform(const Eigen::VectorXd &joint_pos, const std::string &link_name,
                                Eigen::Isometry3d &transform) override;

  bool calculate_jacobian(const Eigen::VectorXd &joint_pos, const std::string &link_name,
                          Eigen::Matrix<double, 6, Eigen::Dynamic> &jacobian) override;

  /// Damped inverse Jᵀ (J Jᵀ + alpha I)⁻¹.
  bool calculate_jacobian_inverse(const Eigen::VectorXd &joint_pos, const std::string &link_name,
                                  Eigen::Matrix<double, Eigen::Dynamic, 6> &jacobian_inverse) override;

  /// Velocity that leads from one frame (x, y, z, qx, qy, qz, qw) to another in `dt` seconds.
  ///
  /// Part of kinematics_interface 2.0 and later, where it overrides.
  // NOLINTNEXTLINE(modernize-use-override)
  bool calculate_frame_difference(Eigen::Matrix<double, 7, 1> &x_a, Eigen::Matrix<double, 7, 1> &x_b, double dt,
                                  Eigen::Matrix<double, 6, 1> &delta_x);

private:
  using Links = std::unordered_map<std::string, kinopt::ArmLink>;

  kinopt::ArmLink *link(const std::string &name);
  bool has_joint_size(Eigen::Index size, const char *what) const;
  /// Writes the Jacobian to `jacobian_`. False for a wrong link, size or value, which is logged.
  bool update_jacobian(const Eigen::VectorXd &joint_pos, const std::string &link_name);
  void update_inverse();

  Links links_;
  Eigen::Index joint_count_ = 0;
  /// Damping of the inverse: added to the eigenvalues of J Jᵀ.
  double alpha_ = 0.0;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> inverse_;
};

} // namespace kinematics_interface_kinopt
