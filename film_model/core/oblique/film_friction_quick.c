/* film_friction with series of a lower order, for errors at which long series bring nothing, in one unit of compilation. */
#define FILM_FRICTION_ORDER 12
#define film_friction film_friction_quick
#define film_friction_depth quick_depth
#define film_friction_first quick_first
#define film_friction_force quick_force
#define film_friction_length quick_length
#define film_friction_powers quick_powers
#define film_friction_root quick_root
#define film_friction_series quick_series
#define film_friction_slide quick_slide
#define film_friction_sound quick_sound
#define film_friction_sum quick_sum
#define film_friction_touched quick_touched
#define film_friction_work quick_work
#include "oblique/film_friction_step.c"

#include "oblique/film_friction.c"
