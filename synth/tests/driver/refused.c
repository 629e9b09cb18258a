/* What posicast_open says of the stage. */
#include "pipe.h"

int main(void)
{
    posicast_stage stage;
    const posicast_result opened = posicast_open(&stage, BASE);

    result("opened", opened);
    result("found", stage.refused.found);
    result("wanted", stage.refused.wanted);
    result(stage.refused.name != NULL ? stage.refused.name : "nothing", 1);
    return 0;
}
