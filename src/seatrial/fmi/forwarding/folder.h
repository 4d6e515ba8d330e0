/* The folder of an FMU's resources, from what hosts pass for it. */

#ifndef FOLDER_H
#define FOLDER_H

/* Write the path of the resources; 0, with the problem written, if pythonfmu cannot use them: its
   library ends the process if it does not find the script, and takes %20 for a space. */
int folder_of(const char *location, char *folder, size_t capacity, char *problem, size_t problem_capacity);

#endif
