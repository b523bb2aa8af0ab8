// Forward kinematics by the product of joint transforms, from the URDF as urdfdom reads it, without kinopt.
#pragma once

#include <map>
#include <string>

#include <Eigen/Geometry>
#include <urdf_model/model.h>

/// Position of each moving joint, radians or metres. Missing joints are at 0.
using Positions = std::map<std::string, double>;

inline Eigen::Isometry3d root_from_link(const urdf::ModelInterface &model, const std::string &name,
                                        const Positions &positions) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (auto link = model.getLink(name); link->parent_joint; link = link->getParent()) {
    const urdf::Joint &joint = *link->parent_joint;
    const urdf::Pose &origin = joint.parent_to_joint_origin_transform;
    const urdf::Rotation &r = origin.rotation;
    const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
    const auto value_of = [&](const std::string &of) { return positions.count(of) ? positions.at(of) : 0.0; };
    double value = value_of(joint.name);
    if (joint.mimic) value = joint.mimic->multiplier * value_of(joint.mimic->joint_name) + joint.mimic->offset;
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS) {
      motion.linear() = Eigen::AngleAxisd(value, axis.normalized()).toRotationMatrix();
    } else if (joint.type == urdf::Joint::PRISMATIC) {
      motion.translation() = value * axis.normalized();
    }
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
    placement.translation() << origin.position.x, origin.position.y, origin.position.z;
    pose = placement * motion * pose;
  }
  return pose;
}

inline Eigen::Isometry3d base_from_link(const urdf::ModelInterface &model, const std::string &base,
                                        const std::string &link, const Positions &positions) {
  return root_from_link(model, base, positions).inverse() * root_from_link(model, link, positions);
}
