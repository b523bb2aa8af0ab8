// Stand-in for pluginlib: a list of the exported classes of each base, by the text of their names.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace pluginlib::stand_in {

template <class Base> std::map<std::string, std::function<std::shared_ptr<Base>()>> &classes() {
  static std::map<std::string, std::function<std::shared_ptr<Base>()>> all;
  return all;
}

template <class Class, class Base> bool add(const std::string &name) {
  return classes<Base>().emplace(name, [] { return std::make_shared<Class>(); }).second;
}

} // namespace pluginlib::stand_in

#define PLUGINLIB_EXPORT_CLASS(Class, Base)                                                                            \
  [[maybe_unused]] static const bool exported = ::pluginlib::stand_in::add<Class, Base>(#Class);
