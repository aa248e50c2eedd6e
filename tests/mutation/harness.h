/* Included into every file of a build for mutation testing (tools/mutation).  Its texts of lib/ have faults that
 * EDML_MUTANT() chooses at run time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MUTATION_HARNESS_H
#define EDML_MUTATION_HARNESS_H

extern int edml_chosen_mutant;       /* 0: none */
extern double edml_mutant_reached[]; /* of a type whose stores alias none of the library's numbers */

#define EDML_MUTANT(number) (edml_mutant_reached[number] = 1, edml_chosen_mutant == (number))

#endif
