# SPDX-License-Identifier: MIT
# What tandem paper takes: its plans, and the Python package with the paper's tables, as part of the harness.
set(texts "")
foreach(size small full)
  file(READ harness/paper/${size}.json text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS harness/paper/${size}.json)
  string(APPEND texts "    if (size == \"${size}\") return R\"PLAN(${text})PLAN\";\n")
endforeach()
set(package "")
file(GLOB modules CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/python python/tandem/*.py python/tandem/paper/*.py)
foreach(module ${modules})
  file(READ python/${module} text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS python/${module})
  string(APPEND package "    {\"${module}\", R\"PYTHON(${text})PYTHON\"},\n")
endforeach()
foreach(number RANGE 1 7)
  file(READ results/paper/table${number}.csv text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS results/paper/table${number}.csv)
  string(APPEND package "    {\"tandem/paper/data/table${number}.csv\", R\"PYTHON(${text})PYTHON\"},\n")
endforeach()
# It draws scenes as scripts/render does.
file(READ scripts/render text)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS scripts/render)
string(APPEND package "    {\"tandem/paper/render.py\", R\"PYTHON(${text})PYTHON\"},\n")
file(CONFIGURE OUTPUT paper_texts.cpp @ONLY CONTENT [=[
#include "harness/paper/python_package.h"
#include "harness/paper/steps.h"
namespace tandem {
std::string_view paper_plan(std::string_view size) {
@texts@    return {};
}
static constexpr PackageFile files[] = {
@package@};
std::span<const PackageFile> python_package() { return files; }
} // namespace tandem
]=])
target_sources(tandem-harness PRIVATE ${PROJECT_BINARY_DIR}/paper_texts.cpp)
