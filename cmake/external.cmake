# SPDX-License-Identifier: MIT
# Subcommands in Python, as programs in libexec/tandem: beside the program in the build folder, and in the installed tree.
foreach(command compare paper)
  file(CONFIGURE OUTPUT libexec/tandem/${command} @ONLY CONTENT [=[#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# tandem @command@: the program starts this, and names itself in TANDEM_PROGRAM.
import os
import pathlib
import sys

sys.dont_write_bytecode = True
installed = pathlib.Path(__file__).resolve().parent / "python"
sys.path.insert(0, str(installed) if installed.is_dir() else "@PROJECT_SOURCE_DIR@/python")
from tandem.commands.@command@ import main

sys.exit(main(sys.argv[1:], os.environ["TANDEM_PROGRAM"]))
]=])
  install(PROGRAMS ${PROJECT_BINARY_DIR}/libexec/tandem/${command} DESTINATION libexec/tandem)
endforeach()
# What accuracy --figures and simulate --pictures draw with.
foreach(script figures render)
  configure_file(scripts/${script} ${PROJECT_BINARY_DIR}/libexec/tandem/${script} COPYONLY)
  install(PROGRAMS scripts/${script} DESTINATION libexec/tandem)
endforeach()
install(DIRECTORY python/tandem DESTINATION libexec/tandem/python FILES_MATCHING PATTERN "*.py" PATTERN "*.json" PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY results/paper/ DESTINATION libexec/tandem/python/tandem/paper/data FILES_MATCHING PATTERN "*.csv")
install(FILES scripts/render DESTINATION libexec/tandem/python/tandem/paper RENAME render.py)
