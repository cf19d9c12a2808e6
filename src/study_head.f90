!> Level 21. The head of a study: what is compared with what, and how its numbers are meant.
module study_head
   use mechanism, only: mechanism_t, instant_count
   use text_output, only: output_t, put
   use numerals, only: whole
   use true_errors, only: truth_t
   use study_plan, only: plan_t
   implicit none
   private
   public :: put_head, put_refusal

   character(*), parameter :: legend(*) = [character(110) :: '', &
      ' Errors: of all links at all steps compared, the largest and the root of the mean square, against the truth', &
      ' at the same instants; in the characteristic length and rate or, where the largest value is more, in parts', &
      ' of it. The truth reads the deck''s decimals with 34 digits: that others round them is a part of their', &
      ' errors. TIME: a step with velocities and accelerations of all links, the first instant left out: median,', &
      ' least and most of 9 measurements. RATIO: to BLOCKS, OWN order, to the limit of ROUNDING: the default.', &
      ' ITER: iterations a step. ORDER of the start of a step: 0 the position before, 1 with its velocity, 2 with', &
      ' its acceleration, 3 with the change of it; OWN: 2 or, BLOCKS, from three instants. SP, QP: kinmat-single,', &
      ' kinmat-quad. MATRIX: reference angles chosen at each step; FIXED: at the first. <: below what the truth', &
      ' can tell.']

contains

   !> The head of the study of `m` as `p` plans it.
   subroutine put_head(o, m, p, truth)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(in) :: p
      type(truth_t), intent(in) :: truth
      integer :: i, known

      known = count(truth%motion%known == 2)
      call put(o, ' '//whole(p%last)//' STEPS, '//whole(size(m%links))//' LINKS; THE TRUTH: kinmat-quad (REAL128), ' &
         //whole(known)//' OF '//whole(size(truth%motion%known))//' INSTANTS COMPARED')
      if (p%last < p%steps .or. (p%steps == 0 .and. p%last < instant_count(m) - 1)) call put(o, &
         ' SHORTENED: THE FIRST '//whole(p%last)//' STEPS OF '//whole(max(p%steps, instant_count(m) - 1)))
      if (p%steps > 0 .and. size(m%at) > 0) call put(o, ' THE INSTANTS OF AT CARDS ARE LEFT OUT')
      if (p%redundant) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: THERE ARE EQUATIONS TOO MANY')
      else if (.not. p%has_dense) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: '//whole(p%equations)//' UNKNOWNS AT ONCE')
      end if
      if (known == 0) call put(o, ' NOT STUDIED: NO MOTION IS FOUND IN REAL128')
      do i = 1, merge(size(legend), 0, known > 0)
         call put(o, trim(legend(i)))
      end do
   end subroutine put_head

   !> Why the set of `p` is passed over.
   subroutine put_refusal(o, p)
      type(output_t), intent(inout) :: o
      type(plan_t), intent(in) :: p

      if (p%last == 0) then
         call put(o, ' NOT STUDIED: THE DECK ASKS FOR ONE INSTANT, AND NO STEP LEADS TO IT')
      else
         call put(o, ' NOT STUDIED: A BLOCK OF '//whole(p%widest) &
            //' UNKNOWNS IS TOO WIDE FOR kinmat-quad, WHICH KNOWS THE TRUTH')
      end if
   end subroutine put_refusal
end module study_head
