# Writes OUTPUT from TEMPLATE with the git revision of ROOT, touching the file only when the revision changed.
#   cmake -DROOT=DIR -DVERSION=x.y.z -DTEMPLATE=FILE -DOUTPUT=FILE -P cmake/WriteRevision.cmake
set(REVISION unknown)
if(EXISTS ${ROOT}/.git)
  execute_process(
    COMMAND git -C ${ROOT} describe --always --dirty --abbrev=12 --match=v*
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE code)
  if(code EQUAL 0)
    set(REVISION ${found})
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
