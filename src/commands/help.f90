!> Texts of `--help`.
module sg_help
  use sg_methods, only: robust_solver
  use sg_print, only: print_line
  implicit none
  private
  public :: help_text, print_help, command_names, look_names

  !> Subcommands, and commands of `look`, which the Python package has
  character(len=*), parameter :: command_names = &
    'run check reference convert bench partition solve spectrum study look movie convex'
  character(len=*), parameter :: look_names = &
    'summary scene movie page thrust split energy solver trace spectrum tracks walls regions field structure'

contains

  !> Print the help of a subcommand, or of all.
  subroutine print_help(command)
    character(len=*), intent(in) :: command !! subcommand, empty for all
    character(len=110), allocatable :: text(:)
    integer :: i

    text = help_text(command)
    do i = 1, size(text)
      call print_line(trim(text(i)))
    end do
  end subroutine print_help

  !> Lines of the help of a subcommand, or of all.
  function help_text(command) result(text)
    character(len=*), intent(in) :: command !! subcommand, empty for all
    character(len=110), allocatable :: text(:)

    select case (command)
    case ('run')
      text = help_on_run()
    case ('check')
      text = help_on_check()
    case ('reference')
      text = help_on_reference()
    case ('convert')
      text = help_on_convert()
    case ('bench')
      text = help_on_bench()
    case ('partition')
      text = help_on_partition()
    case ('solve')
      text = help_on_solve()
    case ('spectrum')
      text = help_on_spectrum()
    case ('study')
      text = help_on_study()
    case ('look')
      text = help_on_look()
    case ('convex')
      text = help_on_convex()
    case default
      text = help_on_commands()
    end select
  end function help_text

  !> Help of `run`.
  function help_on_run() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain run DECK [options]        simulate a deck', &
            '  --output DIR            folder of the results (default: NAME.results in the current folder)', &
            '  --set SECTION.KEY=VALUE set a key over the deck; may be given several times', &
            '  --restart FILE|DIR      go on from a restart file, or from the newest one of a folder', &
            '  --force                 replace results of another run in the folder, or the lock of another host', &
            '  --walltime SECONDS      stop with a checkpoint after this time (exit code 75); also H:M:S, D-H:M:S,', &
            '                          or job: what the batch job leaves, less two minutes', &
            '  --dump STEPS            write the contact problems of steps (10 or 10,20,100-110) as FCLIB files', &
            '  --needs                 at the end, memory by table, libraries loaded, cost of a contact update', &
            '  --quiet                 print nothing but errors', &
            'Signals: INT, TERM, HUP and PIPE finish the step, write a checkpoint and exit with 75; USR1 writes one.', &
            'Exit codes: 0 done, 1 failed, 2 bad input, 3 not converged (if asked), 4 a value is not finite,', &
            '            5 a result cannot be written, 6 the energy balance does not close (if asked),', &
            '            7 memory would run short, 75 stopped early with a checkpoint.']
  end function help_on_run

  !> Help of `check`.
  function help_on_check() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain check DECK [--set SECTION.KEY=VALUE]', &
            'Reads and checks a deck and prints what its run would need, without running it.']
  end function help_on_check

  !> Help of `reference`.
  function help_on_reference() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain reference [option]         all keys of a deck: kind, unit, default, range, meaning', &
            '  --completion            in place of it, completion of words for bash, all keys for --set included', &
            '  --manual                in place of it, the manual page (man)']
  end function help_on_reference

  !> Help of `convert`.
  function help_on_convert() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain convert DATBOX DECK.toml   write a deck that uses an LMGC90 DATBOX folder', &
            '  --script FILE           script of LMGC90 that gives time step, solver and the like, read without running it', &
            '                          (default: command.py next to the folder, where it is; none for none)', &
            '  --set SECTION.KEY=VALUE write a key into the deck; may be given several times', &
            'splitgrain convert DECK.toml FOLDER   write the scene of a deck as DATBOX files', &
            '  --restart FILE|DIR      in the state of a restart file, or of the newest one of a folder of results']
  end function help_on_convert

  !> Help of `bench`.
  function help_on_bench() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain bench [options]            contact updates per CPU second on a generated packing', &
            '  --shape disk            shape of the grains', &
            '  --contacts N            contacts to generate (default 100000)', &
            '  --friction MU           Coulomb friction, 0 for the frictionless kernel (default 0.3)', &
            '  --order NAME            order of the sweep: natural, groups (default) or coloured', &
            '  --threads N             threads that share the sweeps, in coloured order (default 1)', &
            '  --check-every N         sweeps between two tests (default as in decks)', &
            '  --sweeps N              sweeps to do (default: about a second''s work)', &
            '  --momentum              sweeps with Nesterov''s momentum', &
            '  --json                  one flat JSON object']
  end function help_on_bench

  !> Help of `partition`.
  function help_on_partition() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain partition DECK [options]   split the grains of a deck as it starts, without a run', &
            '  --parts N               number of parts (default: partition.parts of the deck)', &
            '  --restart FILE|DIR      in the state of a restart file, or of the newest one of a folder of results', &
            '  --method boxes|graph    boxes of equal weight, or METIS on the graph of contacts (default: the deck''s)', &
            '  --boxes 2x2x1           boxes along x, y and z, 0 for any number (default: the deck''s)', &
            '  --picture FOLDER        write pictures in which the rank of a body is its part, from 0', &
            '  --set SECTION.KEY=VALUE set a key over the deck; may be given several times', &
            '  --json                  one flat JSON object', &
            '  --predict               cost of an iteration on 1, 2, 4, ... N ranks; under mpirun messages are timed', &
            '  --latency US            of messages in microseconds, when they are not timed (default 2)', &
            '  --bandwidth GB          of messages in GB/s, when they are not timed (default 10)', &
            '  --lattice CONTACTS      a lattice as `bench` makes it, in place of a deck; --shape disk|sphere|polyhedron', &
            './start look split FOLDER draws the pictures.']
  end function help_on_partition

  !> Help of `solve`.
  function help_on_solve() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain solve FILE... [options]    solve contact problems in FCLIB files (HDF5)', &
            '  --solver NAME           solver (default: '//robust_solver//'); all for all; may be given several times', &
            '  --tolerance X           e1 to reach (default 1e-8)', &
            '  --iterations N          most iterations (default 100000)', &
            '  --seconds S             most CPU seconds for each problem (default 60)', &
            '  --guess                 start from the first usable guess of the file', &
            '  --trace FILE.csv        write errors against iterations and CPU seconds', &
            '  --write [--force]       add the answer to the file as /solution; --force replaces one that it has', &
            '  --json                  one flat JSON object per line', &
            'Errors are measured from the answers. Exit codes: 0 all solved, 2 bad input (the other files are solved),', &
            '            3 a problem not solved to the tolerance, 5 an answer or the trace cannot be written.']
  end function help_on_solve

  !> Help of `spectrum`.
  function help_on_spectrum() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain spectrum DECK [options]    rate of convergence of interface iterations on the first contact problem', &
            '  --parts N               subdomains (default: those of the deck)', &
            '  --epsilon X             linear interactions: velocity per impulse over the mean diagonal term of W', &
            '                          (default: that of the deck); may be given several times', &
            '  --points N              search directions eta per decade, from 1e-4 to 1e4 of that mean (default 20)', &
            '  --csv FILE              write the spectral radius against eta', &
            '  --restart FILE|DIR      in the state of a restart file, or of the newest one of a folder of results', &
            '  --set SECTION.KEY=VALUE set a key over the deck; may be given several times', &
            'Linear interactions: r = -v/epsilon. Otherwise contact: near the solution, contacts keep their statuses.']
  end function help_on_spectrum

  !> Help of `study`.
  function help_on_study() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain study STUDY.toml [options]   cases x variants x tolerances (or time steps, or subdomains)', &
            '  --output DIR            folder of the study (default: NAME.study in the current folder)', &
            '  --jobs N|all            runs at a time, or one per core (default: that of the study)', &
            '  --part K/N              with [[vary]]: part K of N of the runs, and no page: a task of a job array', &
            '  --program PATH          the splitgrain to run (default: this one)', &
            'Draws error against work, orders of convergence and performance profiles: study.html, PNG, results.csv.', &
            'splitgrain study FOLDER writes an index.html of the studies in its folders.', &
            'Finished runs are kept: the same command goes on with the others. input_decks/studies has examples.', &
            'Exit codes: 0 done, 1 a run failed, or no Python was found, 2 bad input, 5 a result cannot be written,', &
            '            75 stopped early.']
  end function help_on_study

  !> Help of `look`.
  function help_on_look() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain look COMMAND RESULTS [options]   draw what a run wrote (Python 3.11 with h5py, matplotlib, numpy)', &
            'COMMAND is one of', look_names, &
            'splitgrain movie RESULTS [options] is splitgrain look movie.', &
            'splitgrain look COMMAND --help prints the options of a command.']
  end function help_on_look

  !> Help of `convex`.
  function help_on_convex() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain convex MESH.obj [options]     divide non-convex objects into convex parts (Python 3.11, coacd)', &
            '', &
            '  --output FILE       OBJ file to write, for [[blocks]]: one body per object (default MESH.convex.obj)', &
            '  --threshold SHARE   concavity of a part over the size of its object, 0.01 to 1 (default 0.05)']
  end function help_on_convex

  !> All subcommands.
  function help_on_commands() result(text)
    character(len=110), allocatable :: text(:)

    text = [character(len=110) :: &
            'splitgrain: nonsmooth contact dynamics of rigid grains', &
            '', &
            'splitgrain run DECK          simulate', &
            'splitgrain check DECK        everything but the run: counts, memory, features used, every error', &
            'splitgrain reference         print the deck reference', &
            'splitgrain convert FROM TO   LMGC90 DATBOX folder to a deck, or a deck to DATBOX files', &
            'splitgrain bench             measure the sweeps', &
            'splitgrain partition DECK    split the grains into parts: sizes, imbalance, interface', &
            'splitgrain solve FILE...     solve contact problems in FCLIB files, from this program or others', &
            'splitgrain spectrum DECK     spectral radius of the dual and the enriched interface on a small scene', &
            'splitgrain study FILE        error against work: many runs, diagrams, one page', &
            'splitgrain look COMMAND DIR  draw results: scene, movie, energy, solver, summary, ...', &
            'splitgrain convex MESH       divide objects of a mesh into convex parts, for [[blocks]]', &
            'splitgrain --version         version, commit, compiler, flags, libraries', &
            '', &
            'splitgrain COMMAND --help prints more.']
  end function help_on_commands
end module sg_help
