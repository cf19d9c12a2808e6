!> A companion process: this program in another kind of reals, kinmat-quad or kinmat-single. It is asked as
!> anybody may ask it, by a deck, which holds each trial as a set of computations, for the CSV and for the times of
!> --time.
!>
!> The deck's own cards are handed on as they stand, so that the companion reads their decimals itself. The instants are
!> written with an exponent D and 17 digits, which in every kind mean the double.
module companion
   use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_associated, c_null_char
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use failures, only: failure_t, fail, status_system, status_rejected
   use cards, only: card_t, find_form, form_toler, form_time, form_at, form_method, form_print, form_extremes, &
      form_range, form_circuits, form_pole, form_curve, form_branch, form_vary, form_prove, form_end
   use deck_source, only: source_t, open_source, next_card, close_source
   use mechanism, only: mechanism_t, method_newton
   use text_output, only: output_t, open_output, put, close_output
   use numerals, only: whole
   use trials, only: trial_t, outcome_t, samples_of, trial_instants
   implicit none
   private
   public :: ask_companion, put_trial, read_motions, read_times

   interface
      !> mkdtemp(3): makes a directory and completes its name; null on error.
      type(c_ptr) function mkdtemp(template) bind(c)
         import :: c_ptr, c_char
         character(kind=c_char), intent(inout) :: template(*)
      end function mkdtemp
   end interface

   !> What a shell gives back where it does not find a program.
   integer, parameter :: not_found = 127
   !> A row of CSV has nine numbers of at most 44 characters, and less than a hundred others.
   integer, parameter :: row_length = 1024
   real(qp), parameter :: degree = 1.745329251994329576923690768488612713443e-2_qp, none = huge(1.0_qp)
   real(dp), parameter :: micro = 1.0e-6_dp

contains

   !> Lets `program`, which computes in `kind_name` (REAL128, ...), make the `trials` of `m`, which the file `deck`
   !> holds. `outcomes` (trials): what came of them, with times where `timed`. Errors: status_rejected, the deck holds
   !> numbers that are none in that kind; status_system.
   subroutine ask_companion(program, kind_name, deck, m, trials, timed, outcomes, failure)
      character(*), intent(in) :: program, kind_name, deck
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: trials(:)
      logical, intent(in) :: timed
      type(outcome_t), allocatable, intent(out) :: outcomes(:)
      type(failure_t), allocatable, intent(out) :: failure
      character(:), allocatable :: folder
      type(output_t) :: o
      logical :: complete
      integer :: i, status

      allocate (outcomes(size(trials)))
      if (size(trials) == 0) return
      folder = environment('TMPDIR', '/tmp')//'/kinmat-XXXXXX'
      if (.not. made(folder)) then
         call fail(failure, status_system, 'NO FILE CAN BE MADE IN '//environment('TMPDIR', '/tmp'))
         return
      end if
      call open_output(o, folder//'/deck', failure)
      do i = 1, size(trials)
         if (.not. allocated(failure)) call put_trial(o, deck, m, trials(i), failure)
      end do
      if (.not. allocated(failure)) call close_output(o, failure)
      if (.not. allocated(failure)) then
         call execute_command_line(script(program, kind_name, folder, timed), exitstat=status, cmdstat=i)
         complete = status == 0
         if (complete) call read_motions(folder//'/csv', m, trials, outcomes, complete)
         if (complete .and. timed) call read_times(folder//'/times', outcomes, complete)
         if (status == status_rejected) then
            call fail(failure, status_rejected, program//' REFUSES THE DECK')
         else if (status == not_found) then
            call fail(failure, status_system, '--study NEEDS '//program//' BESIDE THIS PROGRAM OR IN PATH: make kinds')
         else if (.not. complete) then
            call fail(failure, status_system, program &
               //' HAS GIVEN NO RESULTS, OR NOT THOSE ASKED FOR (IS IT OF ANOTHER VERSION? make kinds)')
         end if
      end if
      call execute_command_line('rm -rf '//shell_word(folder))
   end subroutine ask_companion

   !> What the shell does: `program`, from the folder of this one if it is there, otherwise from PATH, must be of the
   !> right kind; flagged instants are no failure. A signal that ends it, or this process, leaves no file behind.
   function script(program, kind_name, folder, timed) result(text)
      character(*), intent(in) :: program, kind_name, folder
      logical, intent(in) :: timed
      character(:), allocatable :: text, this
      integer :: length

      call get_command_argument(0, length=length)
      allocate (character(length) :: this)
      if (length > 0) call get_command_argument(0, this)
      text = 'exec 2>/dev/null; d='//shell_word(folder)//'; trap ''rm -rf "$d"; exit 3'' 1 2 13 15; p=' &
         //shell_word(this(:index(this, '/', back=.true.))//program)//'; [ -x "$p" ] || p='//program &
         //'; v=$("$p" --version) || exit; case $v in *'//kind_name//') ;; *) exit 3;; esac' &
         //'; "$p" --csv "$d/csv" -o /dev/null "$d/deck"; s=$?; [ $s = 2 ] || [ $s = 0 ] || exit $s'
      if (timed) text = text//'; "$p" --time -o "$d/times" "$d/deck"; s=$?; [ $s = 2 ] || exit $s'
      text = text//'; kill -0 $PPID || rm -rf "$d"; exit 0'
   end function script

   !> Writes trial `t` of `m` as a set of computations: its cards as they stand in the file `deck`, but for those of
   !> method, instants, variants and what is asked of the motion, and of branches, which METHOD NEWTON alone takes. The
   !> points and pairs are printed too, at the first and the last instant.
   subroutine put_trial(o, deck, m, t, failure)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: deck
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(failure_t), allocatable, intent(out) :: failure
      integer, parameter :: replaced(*) = [form_method, form_time, form_at, form_print, form_extremes, form_range, &
         form_circuits, form_pole, form_curve, form_toler, form_vary, form_prove]
      real(dp) :: instants(0:t%last)
      type(source_t) :: source
      type(card_t) :: card
      character(24) :: number
      logical :: found, kept
      integer :: set, k, form

      call open_source(source, deck, failure)
      set = 1
      kept = .true.
      do while (.not. allocated(failure) .and. set <= m%set_number)
         call next_card(source, card, found, failure)
         if (.not. found) exit
         form = find_form(card%text(:8))
         if (card%text(1:1) /= '*') kept = all(form /= replaced)
         if (form == form_branch) kept = t%method == method_newton
         if (form == form_end) then
            set = set + 1
         else if (set == m%set_number .and. kept) then
            call put(o, trim(card%text))
         end if
      end do
      call close_source(source)
      write (number, '(es24.8)') t%tolerance
      call put(o, 'METHOD  '//merge('NEWTON', 'DENSE ', t%method == method_newton)//repeat(' ', 10)//number)
      number = m%links(first_ground(m))%name
      call put(o, 'PRINT   LINKS   '//number(:8)//whole(t%stride))
      call put(o, 'PRINT   LINKS           '//whole(t%stride))
      call put(o, 'PRINT   ALL             99999999')
      instants = trial_instants(m, t)
      do k = 0, t%last
         write (number, '(es24.16e3)') instants(k)
         number(20:20) = 'D'
         call put(o, 'AT')
         call put(o, '*       '//number)
      end do
      call put(o, 'END')
   end subroutine put_trial

   !> The motions of the `trials` of `m` from the CSV in the file `path`; `complete`: they are all there.
   subroutine read_motions(path, m, trials, outcomes, complete)
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: trials(:)
      type(outcome_t), intent(inout) :: outcomes(:)
      logical, intent(out) :: complete
      real(qp) :: base(3, 0:2)
      integer :: unit, status, i, k, link, last

      open (newunit=unit, file=path, action='read', iostat=status)
      do i = 1, size(trials)
         associate (o => outcomes(i))
            allocate (o%known(samples_of(trials(i))), source=2)
            allocate (o%value(3, size(m%links), 0:2, size(o%known)), source=0.0_qp)
            do k = 1, size(o%known)
               if (status == 0) call read_row(unit, i, (k - 1)*trials(i)%stride, base, last, status)
               do link = 1, size(m%links)
                  if (status /= 0 .or. m%links(link)%ground) cycle
                  call read_row(unit, i, (k - 1)*trials(i)%stride, o%value(:, link, :, k), last, status)
                  o%known(k) = min(o%known(k), last)
                  o%value(:2, link, 0, k) = o%value(:2, link, 0, k) - base(:2, 0)
                  if (m%degrees) o%value(3, link, :, k) = o%value(3, link, :, k)*degree
               end do
            end do
         end associate
      end do
      complete = status == 0
      if (complete) close (unit)
   end subroutine read_motions

   !> The ground link that motions are counted from: its row stands first.
   pure integer function first_ground(m)
      type(mechanism_t), intent(in) :: m

      first_ground = findloc(m%links%ground, .true., 1)
   end function first_ground

   !> The nine numbers (3, 0:2) of the next row of a link at a step; `known`: their last derivative that is there.
   subroutine read_row(unit, set, step, value, known, status)
      integer, intent(in) :: unit, set, step
      real(qp), intent(out) :: value(3, 0:2)
      integer, intent(out) :: known, status
      character(row_length) :: row
      character(5) :: words(2)               ! the time, of which the beginning is enough, and the kind of row
      integer :: place(2), i, comma

      do
         read (unit, '(a)', iostat=status) row
         if (status /= 0) return
         read (row, *, iostat=i) place, words
         ! With card ASSEMBLY the first instant has rows of the other assemblies, too.
         if (i == 0 .and. all(place == [set, step]) .and. words(2) == 'LINK' .and. &
            index(row, ',LINK ASSEMBLY ') == 0) exit
      end do
      ! Before the mark, which stands last; a name may hold commas. What is empty stays as it is.
      comma = len_trim(row) + 1
      do i = 1, 10
         comma = index(row(:comma - 1), ',', back=.true.)
      end do
      value = none
      read (row(comma + 1:), *, iostat=status) value
      known = count([(all(value(:, i) < none), i=0, 2)]) - 1
   end subroutine read_row

   !> Iterations and, where there are any, times of the trials from what --time has written to the file `path`.
   subroutine read_times(path, outcomes, complete)
      character(*), intent(in) :: path
      type(outcome_t), intent(inout) :: outcomes(:)
      logical, intent(out) :: complete
      character(row_length) :: row
      real(dp) :: times(3)
      integer :: unit, status, untimed, i, set, steps
      logical :: is_open

      open (newunit=unit, file=path, action='read', iostat=status)
      is_open = status == 0
      if (status == 0) read (unit, '(a)', iostat=status) row
      do i = 1, size(outcomes)
         if (status == 0) read (unit, '(a)', iostat=status) row
         if (status == 0) read (row, *, iostat=status) set, steps, outcomes(i)%iterations
         outcomes(i)%time = [real(dp) ::]
         if (status == 0) read (row, *, iostat=untimed) set, steps, outcomes(i)%iterations, times
         if (status == 0 .and. untimed == 0) outcomes(i)%time = times*micro
      end do
      complete = status == 0 .and. set == size(outcomes)
      if (is_open) close (unit)
   end subroutine read_times

   !> Makes the folder `name`, whose last six letters become others.
   logical function made(name)
      character(*), intent(inout) :: name
      character(len(name) + 1) :: template

      template = name//c_null_char
      made = c_associated(mkdtemp(template))
      name = template
   end function made

   !> The environment variable `name`, or `default` where it is not set.
   function environment(name, default) result(text)
      character(*), intent(in) :: name, default
      character(:), allocatable :: text
      integer :: length

      call get_environment_variable(name, length=length)
      text = repeat(' ', length)
      if (length > 0) call get_environment_variable(name, text)
      if (length == 0) text = default
   end function environment

   !> `text` as one word of a shell's command.
   pure function shell_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''''
      do i = 1, len(text)
         word = word//text(i:i)
         if (text(i:i) == '''') word = word//'\'''''
      end do
      word = word//''''
   end function shell_word
end module companion
