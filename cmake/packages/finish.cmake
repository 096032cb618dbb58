# Run by cpack on what is to be packed: what Debian wants of a package and CPack does not make. Copyright
# and changes, compressed pages for man, no names of local symbols in libraries.
include(${CPACK_PROJECT_CONFIG_FILE})
set(here ${INNERMAP_SOURCE}/cmake/packages)

function(compress)
  execute_process(COMMAND gzip -9nf ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The date of the commit, so that packages of one commit are the same.
execute_process(COMMAND git log -1 --format=%aD WORKING_DIRECTORY ${INNERMAP_SOURCE}
                OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  execute_process(COMMAND date -uR OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
file(READ ${INNERMAP_SOURCE}/third_party/three/LICENSE three)
string(REGEX REPLACE "^.*(Permission is hereby.*)$" "\\1" three "${three}")
string(STRIP "${three}" three)
string(REPLACE "\n\n" "\n.\n" three "${three}")
string(REPLACE "\n" "\n " three "${three}")

file(GLOB components ${CPACK_TEMPORARY_DIRECTORY}/*)
foreach(folder IN LISTS components)
  get_filename_component(component ${folder} NAME)
  set(name "${INNERMAP_PACKAGE_${component}}")
  if(NOT IS_DIRECTORY ${folder}/usr OR NOT name)
    continue()
  endif()
  set(documents ${folder}/usr/share/doc/${name})
  configure_file(${here}/copyright.in ${documents}/copyright @ONLY)
  configure_file(${here}/changelog.in ${documents}/changelog @ONLY)
  compress(${documents}/changelog)
  file(GLOB_RECURSE pages ${folder}/usr/share/man/*.1)
  if(pages)
    compress(${pages})
  endif()
  file(GLOB_RECURSE archives ${folder}/usr/lib/*.a)
  foreach(archive IN LISTS archives)
    execute_process(COMMAND ${INNERMAP_STRIP} --strip-unneeded --remove-section=.comment
                            --remove-section=.note ${archive} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()
