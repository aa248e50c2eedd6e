/* The model edml_fconv_f32.  Its weights are megabytes of text, so that no sketch compiles them
 * unasked: one that wants the model includes this, in one C file of its own. */
#ifdef __cplusplus
#error "include <edmlift_fconv_f32.h> in a C file, such as a tab fconv.c that has this line alone"
#else
#include "../lib/models/fconv_f32.c"
#endif
