/* Names of statuses.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift.h"

const char *edml_status_name(edml_status status)
{
    switch (status) {
#define EDML_STATUS_CASE(name, value, text)                                                                \
    case name: {                                                                                           \
        static const char said[] = text; /* a linker drops it with the function, but no literal */         \
        return said;                                                                                       \
    }
        EDML_STATUSES(EDML_STATUS_CASE)
#undef EDML_STATUS_CASE
    default:
        return "?";
    }
}
