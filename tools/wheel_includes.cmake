# Given to CMake as CMAKE_PROJECT_INCLUDE when ROS 2 comes from wheels. Their exported targets name
# the Python headers of the machine that built them (/opt/python/...), and CMake refuses an imported
# target with an include folder that does not exist. A ROS 2 installation needs none of this: that is
# why it is here and not in a CMakeLists.txt.

function(drop_missing_wheel_includes)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(NOT folders)
      continue()
    endif()
    set(kept "")
    foreach(folder IN LISTS folders)
      if(NOT folder MATCHES "^/opt/python/" OR EXISTS "${folder}")
        list(APPEND kept "${folder}")
      endif()
    endforeach()
    set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${kept}")
  endforeach()
endfunction()

# At the end of the project's CMakeLists.txt: every find_package has run by then.
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL drop_missing_wheel_includes)
