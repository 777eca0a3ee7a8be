/* Everything as one unit, so that nothing but the functions of the interface is visible outside. */

#include "@TYPES@"
#include "export.h"
#include "dense.c"
#include "exponential.c"
#include "model.h"
#include "system.c"
#include "stepping.c"
#include "model.c"
#include "instance.c"
#include "advancing.c"
#include "services.c"
@FUNCTIONS@
