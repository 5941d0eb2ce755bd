# SPDX-License-Identifier: MIT
# Whether the compiled half of the Python package is built, and with what. Included before the library's targets: a shared
# module takes position-independent code only.
set(TANDEM_PYTHON AUTO CACHE STRING "Build the Python module: ON, OFF, or AUTO where nanobind and Python's headers are")
set(TANDEM_BUILDS_PYTHON OFF)
if(TANDEM_PYTHON STREQUAL AUTO AND TANDEM_SANITIZE)
  return() # the interpreter would have to be sanitized as well
endif()
if(TANDEM_PYTHON)
  # The interpreter that the tests are run with, unless pip builds for its own.
  if(NOT SKBUILD AND NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python_EXECUTABLE /usr/bin/python3)
  endif()
  set(required)
  if(NOT TANDEM_PYTHON STREQUAL AUTO)
    set(required REQUIRED)
  endif()
  find_package(Python 3.11 ${required} COMPONENTS Interpreter Development.Module)
  find_package(nanobind CONFIG ${required} PATHS ${PROJECT_SOURCE_DIR}/.cache/python/nanobind/cmake) # of scripts/setup
  if(Python_Development.Module_FOUND AND nanobind_FOUND)
    set(TANDEM_BUILDS_PYTHON ON)
  else()
    message(STATUS "no nanobind or no headers of Python: tandem.Collider is not built (scripts/setup fetches both)")
  endif()
endif()
