# Arrows go down only: fails when a room includes a header of a room above it.
#   cmake -DROOT=DIR -P cmake/CheckRooms.cmake
set(rooms core kernels physics io app)  # lowest first

set(wrong)
set(above ${rooms})
foreach(room IN LISTS rooms)
  list(REMOVE_ITEM above ${room})
  list(JOIN above "|" forbidden)
  file(GLOB_RECURSE files ${ROOT}/${room}/*.hpp ${ROOT}/${room}/*.cpp)
  foreach(file IN LISTS files)
    if(NOT forbidden)
      continue()
    endif()
    file(STRINGS ${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]+[\"<](\\.\\./)*(${forbidden})/")
    foreach(include IN LISTS includes)
      file(RELATIVE_PATH name ${ROOT} ${file})
      list(APPEND wrong "  ${name}: ${include}")
    endforeach()
  endforeach()
endforeach()

if(wrong)
  list(JOIN wrong "\n" lines)
  message(FATAL_ERROR "rooms may only include from the rooms below them (${rooms}, lowest first):\n${lines}")
endif()
