// Stand-in for rclcpp's node: parameters only.
#pragma once

#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "rclcpp/node_interfaces/node_parameters_interface.hpp"
#include "rclcpp/parameter.hpp"

namespace rclcpp {

class Node : public node_interfaces::NodeParametersInterface {
public:
  using SharedPtr = std::shared_ptr<Node>;

  void declare_parameter(const std::string &name, const Parameter::Value &value) {
    if (!parameters_.emplace(name, value).second)
      throw std::runtime_error("parameter '" + name + "' is declared already");
  }
  bool has_parameter(const std::string &name) const override { return parameters_.count(name) > 0; }
  Parameter get_parameter(const std::string &name) const { return {name, parameters_.at(name)}; }
  bool get_parameter(const std::string &name, Parameter &parameter) const override {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) return false;
    parameter = {name, found->second};
    return true;
  }

private:
  std::map<std::string, Parameter::Value> parameters_;
};

} // namespace rclcpp
