# Debian's own packages keep Python modules in /usr/lib/python3, not in the folder of one version that an installation
# to /usr/local needs.
file(GLOB found ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python/usr/lib/python3.*/dist-packages)
if(found)
  file(MAKE_DIRECTORY ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python/usr/lib/python3)
  file(RENAME ${found} ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python/usr/lib/python3/dist-packages)
  cmake_path(GET found PARENT_PATH version_folder)
  file(REMOVE ${version_folder})
endif()
