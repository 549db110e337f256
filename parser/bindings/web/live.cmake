# SPDX-License-Identifier: GPL-3.0-or-later
# The engine as one classic script that a page carries inside: strut-live.js. `strut view --live` and the notebook
# view put it into their pages (engine/output/page/page.h).
find_program(STRUT_ESBUILD esbuild NO_CMAKE_FIND_ROOT_PATH)
find_program(STRUT_NODE NAMES node nodejs NO_CMAKE_FIND_ROOT_PATH)
mark_as_advanced(STRUT_ESBUILD STRUT_NODE)
if(NOT STRUT_ESBUILD OR NOT STRUT_NODE)
  message(STATUS "strut-live.js is not built: it needs the Debian packages esbuild and nodejs")
  return()
endif()

set(live_dir "${CMAKE_CURRENT_BINARY_DIR}/live")
set(live_package "${PROJECT_BINARY_DIR}/package")
set(live_sources client/live.js client/engine.js client/scale.js client/worker.js client/squeeze.mjs package/index.js
                 package/memory.js)
list(TRANSFORM live_sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
set(live_head "/* strut ${PROJECT_VERSION} for browsers. SPDX-License-Identifier: GPL-3.0-or-later */")
set(bundle "${STRUT_ESBUILD}" --bundle --format=iife --minify --target=es2022 --log-level=warning
           "--define:import.meta.url=\"\"" --external:node:fs/promises --legal-comments=none)

add_custom_command(
  OUTPUT "${PROJECT_BINARY_DIR}/strut-live.js"
  COMMAND "${CMAKE_COMMAND}" -E make_directory "${live_dir}/package" "${live_dir}/client"
  COMMAND "${CMAKE_COMMAND}" -E copy package/index.js package/memory.js "${live_package}/strut.mjs"
          "${live_dir}/package"
  COMMAND "${CMAKE_COMMAND}" -E copy client/live.js client/engine.js client/scale.js client/worker.js "${live_dir}/client"
  COMMAND "${STRUT_NODE}" client/squeeze.mjs "${live_package}/strut.wasm" "${live_dir}/client/strut.wasm.deflated"
  COMMAND ${bundle} "--outfile=${live_dir}/client/worker.bundle" "${live_dir}/client/worker.js"
  COMMAND ${bundle} --loader:.bundle=text --loader:.deflated=base64
          "--banner:js=${live_head}"
          "--outfile=${PROJECT_BINARY_DIR}/strut-live.js" "${live_dir}/client/live.js"
  DEPENDS ${live_sources} strut_web "${live_package}/strut.wasm"
  WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  COMMENT "Bundling strut-live.js"
  VERBATIM)
add_custom_target(strut_live ALL DEPENDS "${PROJECT_BINARY_DIR}/strut-live.js")
