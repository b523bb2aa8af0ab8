// Stand-in for the interface of a node's parameters: the two functions that plugins use.
#pragma once

#include <string>

#include "rclcpp/parameter.hpp"

namespace rclcpp::node_interfaces {

class NodeParametersInterface {
public:
  virtual ~NodeParametersInterface() = default;
  virtual bool has_parameter(const std::string &name) const = 0;
  virtual bool get_parameter(const std::string &name, rclcpp::Parameter &parameter) const = 0;
};

} // namespace rclcpp::node_interfaces
