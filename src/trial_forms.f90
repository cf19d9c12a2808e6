!> Level 3. One way of solving a set of computations, as --study tries it, and what came of it. A way is told to another
!> process in one word, SET/METHOD/TOLERANCE/PREDICTOR/KEEPS/STEPS/LAST/STRIDE/REPEATS.
module trial_forms
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use mechanism, only: method_newton, method_dense, own_predictor
   implicit none
   private
   public :: trial_t, outcome_t, word_of, read_trial, samples_of

   type :: trial_t
      integer :: set = 1
      integer :: method = method_newton
      real(dp) :: tolerance = 0.0_dp             !< 0: the limit of rounding
      integer :: predictor = own_predictor       !< order of the start of a step, or the method's own
      logical :: keeps = .false.                 !< the references of the first instant, for good
      integer :: steps = 0                       !< of the whole time of the deck; 0: the instants of its AT cards
      integer :: last = 0                        !< the last step that is made, 0 <= last
      integer :: stride = 1                      !< the motion is kept at steps 0, stride, 2 stride, ...
      integer :: repeats = 0                     !< measurements of its time
   end type trial_t

   !> In the deck's units; angles in radians.
   type :: outcome_t
      integer :: digits = 0                      !< binary digits of the kind that has found it
      real(dp) :: iterations = 0.0_dp            !< a step, those of divided steps included
      integer, allocatable :: known(:)           !< (samples) -1: no position; 2: accelerations too
      real(qp), allocatable :: value(:, :, :, :) !< (3, links, 0:2, samples)
      real(dp), allocatable :: time(:)           !< (repeats) seconds a step but the first instant; none: not timed
   end type outcome_t

   character(*), parameter :: form = '(i0,"/",i0,"/",es23.16e3,"/",i0,"/",l1,4("/",i0))'

contains

   !> Motions that are kept of trial `t`.
   pure integer function samples_of(t)
      type(trial_t), intent(in) :: t

      samples_of = t%last/t%stride + 1
   end function samples_of

   function word_of(t) result(word)
      type(trial_t), intent(in) :: t
      character(:), allocatable :: word
      character(120) :: line

      write (line, form) t%set, t%method, t%tolerance, t%predictor, t%keeps, t%steps, t%last, t%stride, t%repeats
      line = adjustl(line)
      word = trim(line)
      do while (index(word, ' ') > 0)
         word = word(:index(word, ' ') - 1)//word(index(word, ' ') + 1:)
      end do
   end function word_of

   !> The trial that `word` tells; `good`: it is one.
   subroutine read_trial(word, t, good)
      character(*), intent(in) :: word
      type(trial_t), intent(out) :: t
      logical, intent(out) :: good
      character(len(word)) :: line
      integer :: i, slashes, status

      slashes = 0
      line = word
      do i = 1, len(word)
         if (word(i:i) /= '/') cycle
         slashes = slashes + 1
         line(i:i) = ' '
      end do
      good = slashes == 8 .and. verify(word, '0123456789/+-.ETF') == 0
      if (.not. good) return
      read (line, *, iostat=status) t%set, t%method, t%tolerance, t%predictor, t%keeps, t%steps, t%last, t%stride, &
         t%repeats
      good = status == 0
      if (.not. good) return
      good = t%set > 0 .and. t%method >= method_newton .and. t%method <= method_dense .and. t%tolerance >= 0.0_dp &
         .and. t%predictor >= own_predictor .and. t%predictor <= 3 .and. t%steps >= 0 .and. t%last >= 0 &
         .and. t%stride > 0 .and. t%repeats >= 0
   end subroutine read_trial
end module trial_forms
