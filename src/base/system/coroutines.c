/* Coroutines: procedures that take turns in one thread of the system, each on a stack of its own. A turn ends where a
   coroutine yields; the next one, in the order of their numbers, goes on. They hold the state of the process, of which there
   is one: the crew that runs now. */
#define _GNU_SOURCE
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <ucontext.h>
#include <unistd.h>

/* Address sanitizer keeps a record of the stack in use, where it is linked. */
#pragma weak __sanitizer_start_switch_fiber
#pragma weak __sanitizer_finish_switch_fiber
void __sanitizer_start_switch_fiber(void **fake_stack, const void *bottom, size_t bytes);
void __sanitizer_finish_switch_fiber(void *fake_stack, const void **bottom, size_t *bytes);

typedef struct {
  ucontext_t context;
  char *stack;
  void *fake_stack;
  double seconds; /* CPU time when its turn ended, minus that of the turns of others */
  int is_done;
} coroutine_t;

static struct {
  coroutine_t *members; /* the last one is the caller, on the stack of the thread */
  int n, current, left, vain;
  size_t bytes;
  double turned; /* CPU time at the last switch */
  const void *first_bottom;
  size_t first_bytes;
  void (*body)(void *, int);
  void *data;
} crew;

static double cpu_seconds(void)
{
  struct rusage used;

  getrusage(RUSAGE_SELF, &used);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

static void arrive(void)
{
  if (__sanitizer_finish_switch_fiber) {
    const void *bottom;
    size_t bytes;

    __sanitizer_finish_switch_fiber(crew.members[crew.current].fake_stack, &bottom, &bytes);
    if (crew.first_bytes == 0) {
      crew.first_bottom = bottom;
      crew.first_bytes = bytes;
    }
  }
}

static void switch_to(int next)
{
  coroutine_t *from = &crew.members[crew.current], *to = &crew.members[next];
  double now = cpu_seconds();

  from->seconds += now - crew.turned;
  crew.turned = now;
  crew.current = next;
  if (__sanitizer_start_switch_fiber)
    __sanitizer_start_switch_fiber(from->is_done ? NULL : &from->fake_stack, to->stack ? to->stack : crew.first_bottom,
                                   to->stack ? crew.bytes : crew.first_bytes);
  swapcontext(&from->context, &to->context);
  arrive();
}

static int next_one(void)
{
  int i, next = crew.current;

  for (i = 0; i < crew.n; i++) {
    next = (next + 1) % crew.n;
    if (!crew.members[next].is_done)
      return next;
  }
  return crew.n;
}

static void enter(void)
{
  arrive();
  crew.body(crew.data, crew.current);
  crew.members[crew.current].is_done = 1;
  crew.left--;
  crew.vain = 0;
  switch_to(next_one());
}

static void give_back_stacks(long page)
{
  int i;

  for (i = 0; i < crew.n; i++)
    if (crew.members[i].stack)
      munmap(crew.members[i].stack - page, crew.bytes + (size_t)page);
  free(crew.members);
  crew.members = NULL;
}

/* A coroutine has as much stack as the program itself may take; where that has no limit, 64 megabytes. */
static size_t stack_bytes(long page)
{
  struct rlimit limit;
  rlim_t bytes = (rlim_t)1 << 26;

  if (getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < bytes)
    bytes = limit.rlim_cur;
  return (size_t)(bytes + (rlim_t)page - 1) / (size_t)page * (size_t)page;
}

/* Run body(data, 0) to body(data, n - 1) as coroutines until all have returned. The answer is not zero where there is no
   memory for their stacks. */
int splitgrain_coroutines(int n, void (*body)(void *, int), void *data)
{
  long page = sysconf(_SC_PAGESIZE);
  int i;

  crew.members = calloc((size_t)n + 1, sizeof(coroutine_t));
  if (!crew.members)
    return 1;
  crew.n = n;
  crew.left = n;
  crew.vain = 0;
  crew.first_bytes = 0;
  crew.bytes = stack_bytes(page);
  crew.body = body;
  crew.data = data;
  crew.turned = cpu_seconds();
  for (i = 0; i <= n; i++)
    crew.members[i].seconds = crew.turned;
  for (i = 0; i < n; i++) {
    /* Pages get memory when they are used; the lowest one is left without, and a stack that is full ends the program there. */
    char *stack = mmap(NULL, crew.bytes + (size_t)page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);

    if (stack == MAP_FAILED || mprotect(stack + page, crew.bytes, PROT_READ | PROT_WRITE) != 0) {
      if (stack != MAP_FAILED)
        munmap(stack, crew.bytes + (size_t)page);
      give_back_stacks(page);
      return 1;
    }
    crew.members[i].stack = stack + page;
    getcontext(&crew.members[i].context);
    crew.members[i].context.uc_stack.ss_sp = crew.members[i].stack;
    crew.members[i].context.uc_stack.ss_size = crew.bytes;
    makecontext(&crew.members[i].context, enter, 0);
  }
  crew.current = n;
  switch_to(0);
  give_back_stacks(page);
  return 0;
}

/* Let the others have their turns. The answer is how many turns in a row have been in vain by now, over the number of
   coroutines that have not returned. */
double splitgrain_yield(void)
{
  int next;

  if (!crew.members)
    return ++crew.vain;
  next = next_one();
  crew.vain++;
  if (next != crew.current)
    switch_to(next);
  return (double)crew.vain / crew.left;
}

/* Something has happened that others may wait for: turns are not in vain. */
void splitgrain_progress(void)
{
  crew.vain = 0;
}

/* CPU seconds that others have used since the coroutines began; zero where there are none. */
double splitgrain_elsewhere(void)
{
  return crew.members ? crew.turned - crew.members[crew.current].seconds : 0;
}
