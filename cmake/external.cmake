# SPDX-License-Identifier: MIT
# tandem_external(NAME MODULE [TOOL]): writes libexec/tandem/NAME, a program that runs main() of a module of the Python package.
# It is beside `tandem` in the build folder and in the installed tree. TOOL: also installed as this program, for users to start.
function(tandem_external name module)
  file(CONFIGURE OUTPUT libexec/tandem/${name} @ONLY CONTENT [=[#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Runs tandem.@module@. When the program tandem starts this file, TANDEM_PROGRAM is that program's name.
import os
import pathlib
import sys

sys.dont_write_bytecode = True
folder = pathlib.Path(__file__).resolve().parent
installed = [package for package in (folder / "python", folder.parent / "libexec/tandem/python") if package.is_dir()]
sys.path.insert(0, str(installed[0]) if installed else "@PROJECT_SOURCE_DIR@/python")
from tandem.@module@ import main

sys.exit(main(sys.argv[1:], os.environ.get("TANDEM_PROGRAM", "tandem")))
]=])
  install(PROGRAMS ${PROJECT_BINARY_DIR}/libexec/tandem/${name} DESTINATION libexec/tandem)
  if(ARGC GREATER 2)
    install(PROGRAMS ${PROJECT_BINARY_DIR}/libexec/tandem/${name} DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${ARGV2})
  endif()
endfunction()

include(GNUInstallDirs)
tandem_external(compare commands.compare)
tandem_external(paper commands.paper)
tandem_external(report commands.report)
tandem_external(view commands.view)
tandem_external(export-csv commands.export_csv)
tandem_external(convert commands.convert)
tandem_external(figures error_figures tandem-figures)
tandem_external(tables tables tandem-tables)
# JavaScript libraries of Debian's packages that draw charts and scenes in report pages. The commands search this folder and
# /usr/share/javascript.
foreach(library chart.js/chart.min.js three/three.min.js three/examples/js/controls/OrbitControls.js)
  if(EXISTS /usr/share/javascript/${library})
    configure_file(/usr/share/javascript/${library} ${PROJECT_BINARY_DIR}/libexec/tandem/javascript/${library} COPYONLY)
    cmake_path(GET library PARENT_PATH folder)
    install(FILES ${PROJECT_BINARY_DIR}/libexec/tandem/javascript/${library} DESTINATION libexec/tandem/javascript/${folder})
  else()
    message(STATUS "no /usr/share/javascript/${library}: tandem report and view name its package (Debian: libjs-three, libjs-chart.js)")
  endif()
endforeach()
# simulate --pictures draws with it.
configure_file(scripts/render ${PROJECT_BINARY_DIR}/libexec/tandem/render COPYONLY)
install(PROGRAMS scripts/render DESTINATION libexec/tandem)
install(DIRECTORY python/tandem DESTINATION libexec/tandem/python FILES_MATCHING PATTERN "*.py" PATTERN "*.json" PATTERN "*.toml" PATTERN "*.css" PATTERN "*.js" PATTERN "*.html" PATTERN "*.svg"
        PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY results/paper/ DESTINATION libexec/tandem/python/tandem/paper/data FILES_MATCHING PATTERN "*.csv")
install(FILES scripts/render DESTINATION libexec/tandem/python/tandem/paper RENAME render.py)
