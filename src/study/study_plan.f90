!> What --study tries on one set of computations: how many steps, which instants are compared, which trials.
module study_plan
   use, intrinsic :: iso_fortran_env, only: dp => real64, int64
   use mechanism, only: mechanism_t, instant_count, method_dense, method_matrix, own_predictor
   use block_engine, only: block_engine_t, make_block_engine
   use trials, only: trial_t, kind_single, kind_double, kind_quad
   implicit none
   private
   public :: plan_t, new_plan, plan_trials, truth_trial, default_trial
   public :: section_kinds

   integer, parameter :: section_tolerance = 1, section_steps = 2, section_predictor = 3, section_kinds = 4

   !> Coordinates of links at instants: of so many the truth is kept, of so many a finer march is made, so many are
   !> solved at all.
   integer, parameter :: max_kept = 50000, max_fine = 60000, max_solved = 1000000
   !> Equations that are solved all at once; by real128 too.
   integer, parameter :: max_equations = 130, max_quad_equations = 39
   !> Microseconds of real128: all, a link, and the cube of a block's width.
   real(dp), parameter :: max_time = 1.5e7_dp, link_time = 20.0_dp, cube_time = 0.2_dp
   integer, parameter :: min_truths = 4

   type :: plan_t
      integer :: steps = 0, last = 0             !< of the deck; 0 steps: those between the instants of its AT cards
      integer :: finer = 1                       !< the finest march makes so many steps of one
      integer :: coarser = 1                     !< the coarsest makes one of so many
      integer :: skip = 1                        !< of the finest steps, those that are compared
      integer :: widest = 0                      !< block, unknowns
      integer :: equations = 0                   !< at once
      logical :: possible = .true.               !< for a program in real128
      logical :: redundant = .false.             !< there are equations too many
      logical :: has_dense = .true.              !< all equations at once are not too many
   end type plan_t

contains

   !> The plan of `m`; `redundant`: it has equations too many.
   function new_plan(m, redundant) result(p)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: redundant
      type(plan_t) :: p
      integer :: links

      links = size(m%links)
      p%equations = 3*count(.not. m%links%ground)
      p%redundant = redundant
      p%has_dense = p%equations <= max_equations .and. .not. redundant
      if (m%steps > 0) then
         p%steps = m%steps
         p%last = min(m%steps, max(8, max_solved/links))
      else
         p%last = min(instant_count(m) - 1, max(8, max_solved/links))
      end if
      if (p%last < p%steps) p%last = p%last - mod(p%last, 4)
      call limit_truth(m, p)
      if (p%steps == 0) return
      if (mod(p%steps, 4) == 0 .and. mod(p%last, 4) == 0 .and. p%last >= 8) p%coarser = 4
      do while (p%finer < 16 .and. int(4*p%finer, int64)*p%last*links <= max_fine)
         p%finer = 4*p%finer
      end do
      do while (mod(p%steps*p%finer, 2*p%skip) == 0 .and. int(p%last, int64)*p%finer/p%skip*links > max_kept)
         p%skip = 2*p%skip
      end do
   end function new_plan

   !> As many instants as a program in real128 solves in a short time: it knows no sparse matrices.
   subroutine limit_truth(m, p)
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(inout) :: p
      type(block_engine_t) :: e
      real(dp) :: time
      integer :: i, possible

      call make_block_engine(e, m)
      time = link_time*size(m%links)
      do i = 1, size(e%needed)
         associate (n => e%blocks%list(e%needed(i))%shape%n)
            p%widest = max(p%widest, n)
            time = time + cube_time*real(n, dp)**3
         end associate
      end do
      possible = int(min(max_time/time, 1.0e9_dp))
      p%possible = possible >= min_truths
      if (possible >= 16) possible = possible - mod(possible, 4)
      p%last = min(p%last, max(possible, min_truths))
   end subroutine limit_truth

   !> The trial that is the truth: real128, to the limit of rounding, at all instants that are compared.
   pure type(trial_t) function truth_trial(p) result(t)
      type(plan_t), intent(in) :: p

      t = trial_t(kind=kind_quad, steps=p%steps*p%finer/p%skip, last=p%last*p%finer/p%skip)
   end function truth_trial

   !> METHOD NEWTON to the limit of rounding at the deck's steps.
   pure type(trial_t) function default_trial(p) result(t)
      type(plan_t), intent(in) :: p

      t = at_steps(p, trial_t(), 1, 1)
   end function default_trial

   !> `t` in steps of which `finer` are `coarser` of the deck's.
   pure type(trial_t) function at_steps(p, t, finer, coarser) result(one)
      type(plan_t), intent(in) :: p
      type(trial_t), intent(in) :: t
      integer, intent(in) :: finer, coarser

      one = t
      one%steps = p%steps*finer/coarser
      one%last = p%last*finer/coarser
      one%stride = max(1, p%skip*finer/(p%finer*coarser))
   end function at_steps

   !> All trials, section by section.
   function plan_trials(p) result(trials)
      type(plan_t), intent(in) :: p
      type(trial_t), allocatable :: trials(:)
      real(dp), parameter :: tolerances(10) = [1.0e-2_dp, 1.0e-3_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp, 1.0e-10_dp, &
         1.0e-12_dp, 1.0e-14_dp, 1.0e-15_dp, 0.0_dp]
      type(trial_t), allocatable :: methods(:)
      integer :: i, k

      methods = [trial_t(), trial_t(method=method_dense), trial_t(method=method_matrix), &
         trial_t(method=method_matrix, keeps=.true.)]
      if (.not. p%has_dense) methods = methods(:1)
      allocate (trials(0))
      do i = 1, size(methods)
         call add(section_tolerance, methods(i), tolerances, 1, 1)
         if (i == 1 .and. p%finer > 1) call add(section_tolerance, methods(i), tolerances, p%finer, 1)
      end do
      do i = 1, size(methods)
         if (p%coarser > 1) call add(section_steps, methods(i), [0.0_dp], 1, p%coarser)
         k = 1
         do while (k <= p%finer)
            call add(section_steps, methods(i), [0.0_dp], k, 1)
            k = 4*k
         end do
      end do
      do i = 1, min(3, size(methods))
         call add_predictors(methods(i), merge(1, 2, i > 1), 1)
         if (p%finer > 1 .and. i < 3) call add_predictors(methods(i), merge(1, 2, i > 1), p%finer)
      end do
      call add_kinds()

   contains

      !> Trial `t` in one section, for each of some tolerances.
      subroutine add(section, t, tolerances, finer, coarser)
         integer, intent(in) :: section, finer, coarser
         type(trial_t), intent(in) :: t
         real(dp), intent(in) :: tolerances(:)
         type(trial_t) :: one
         integer :: k

         one = at_steps(p, t, finer, coarser)
         one%section = section
         do k = 1, size(tolerances)
            one%tolerance = tolerances(k)
            trials = [trials, one]
         end do
      end subroutine add

      !> Predictors of orders 0 to 3 and the method's own, for one tolerance or two.
      subroutine add_predictors(t, count, finer)
         type(trial_t), intent(in) :: t
         integer, intent(in) :: count, finer
         real(dp), parameter :: tolerances(2) = [0.0_dp, 1.0e-6_dp]
         type(trial_t) :: one
         integer :: order

         one = t
         do order = 0, 4
            one%predictor = merge(own_predictor, order, order == 4)
            call add(section_predictor, one, tolerances(:count), finer, 1)
         end do
      end subroutine add_predictors

      !> Single, double and real128. The first one in double is the default.
      subroutine add_kinds()
         real(dp), parameter :: few(4) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 0.0_dp]
         real(dp), parameter :: many(6) = [1.0e-2_dp, 1.0e-8_dp, 1.0e-15_dp, 1.0e-20_dp, 1.0e-30_dp, 0.0_dp]
         integer :: kind

         do kind = kind_single, kind_quad
            if (kind == kind_single) call add(section_kinds, trial_t(kind=kind), few, 1, 1)
            if (kind == kind_double) call add(section_kinds, trial_t(kind=kind), [0.0_dp], 1, 1)
            if (kind == kind_quad) call add(section_kinds, trial_t(kind=kind), &
               many(merge(1, size(many), p%finer > 1 .or. p%steps == 0):), 1, 1)
            if (p%has_dense .and. (kind /= kind_quad .or. p%equations <= max_quad_equations)) &
               call add(section_kinds, trial_t(kind=kind, method=method_dense), [0.0_dp], 1, 1)
         end do
      end subroutine add_kinds
   end function plan_trials
end module study_plan
