# SPDX-License-Identifier: MIT
# What libsagitta-render stands on. Read by the project's own build and, installed, by find_package(sagitta COMPONENTS render).
# Sets SAGITTA_RENDER_LIBRARIES and SAGITTA_RENDER_DEFINITIONS.
find_package(PkgConfig REQUIRED)
pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET assimp)
pkg_check_modules(CJSON REQUIRED IMPORTED_TARGET libcjson)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(ZLIB REQUIRED)
set(SAGITTA_RENDER_LIBRARIES PkgConfig::ASSIMP PkgConfig::CJSON PNG::PNG JPEG::JPEG ZLIB::ZLIB)
set(SAGITTA_RENDER_DEFINITIONS "")

# OpenEXR has its C interface since version 3.1; with an older one (Ubuntu 22.04) EXR files are refused with a message. Its own
# CMake package does not load where its Python part is not installed (Debian 12), so pkg-config says where it is.
pkg_check_modules(OPENEXR QUIET OpenEXR>=3.1)
if(OPENEXR_FOUND)
  list(FILTER OPENEXR_LIBRARIES INCLUDE REGEX "OpenEXRCore")
  find_library(SAGITTA_OPENEXR_CORE ${OPENEXR_LIBRARIES} HINTS ${OPENEXR_LIBRARY_DIRS} REQUIRED)
  if(NOT TARGET sagitta-openexr-core)
    add_library(sagitta-openexr-core INTERFACE IMPORTED)
    set_target_properties(sagitta-openexr-core PROPERTIES INTERFACE_LINK_LIBRARIES ${SAGITTA_OPENEXR_CORE}
      INTERFACE_INCLUDE_DIRECTORIES "${OPENEXR_INCLUDE_DIRS}")
  endif()
  list(APPEND SAGITTA_RENDER_LIBRARIES sagitta-openexr-core)
  list(APPEND SAGITTA_RENDER_DEFINITIONS SAGITTA_HAVE_OPENEXR=1)
else()
  message(STATUS "OpenEXR 3.1 or newer not found: built without EXR files")
  list(APPEND SAGITTA_RENDER_DEFINITIONS SAGITTA_HAVE_OPENEXR=0)
endif()
