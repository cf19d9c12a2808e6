!> Tests. `print_expected DECK` prints, from the closed form in real128, the listing that `kinmat DECK` must print.
!> The deck is read and the lines are laid out by the program's own modules; no solver is used.
program print_expected
   use, intrinsic :: iso_fortran_env, only: error_unit
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, instant_count, instant, method_newton, drive_angle
   use motion, only: motion_t, new_motion, forget_links, mark_none, mark_singular, singular_change
   use structure, only: findings_t
   use branch_certificate, only: certificate_counts_t
   use hand_groups, only: groups_by_hand, redundant_by_hand, passages_by_hand
   use deck, only: read_deck
   use text_output, only: output_t, open_output, close_output
   use listing, only: layout_t, new_layout, listing_head, listing_instant, listing_end
   use quad_jet, only: qp, pi_q
   use scales, only: characteristic_length
   use error_estimate, only: error_estimate_t, find_estimates
   use set_motion, only: one_motion
   use perturbed_deck, only: perturbed, perturbed_instant, sample_count
   use closed_forms_dyads, only: body_t
   use closed_forms_hard, only: pushed_slider
   use deck_tally, only: deck_name
   use closed_forms, only: closed_form, hand_count
   implicit none
   character(500) :: path
   character(:), allocatable :: name, report
   type(mechanism_t), allocatable :: sets(:)
   type(failure_t), allocatable :: failure
   type(output_t) :: o
   integer :: i

   call get_command_argument(1, path)
   name = deck_name(trim(path))
   if (size(closed_form(name, 1, 0.0_qp)) == 0) call give_up('NO CLOSED FORM FOR THE DECK '//trim(path))
   call read_deck(trim(path), sets, report, failure)
   if (allocated(failure)) call give_up(failure%text//new_line('a')//report)
   call open_output(o, '', failure)
   do i = 1, size(sets)
      call print_set(o, name, sets(i))
   end do
   call close_output(o, failure)
   if (allocated(failure)) call give_up(failure%text)

contains

   !> The listing of one set.
   subroutine print_set(o, name, m)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(layout_t) :: layout
      type(motion_t) :: q
      type(findings_t) :: findings
      type(error_estimate_t) :: doubt
      type(certificate_counts_t) :: tally
      integer :: k, flagged

      layout = new_layout(m)
      findings = hand_count(name)
      findings%groups = groups_by_hand(name, m)
      call listing_head(o, layout, m, findings)
      q = new_motion(size(m%links))
      do k = 1, size(m%links)
         q%position(:, k) = m%links(k)%position
      end do
      flagged = 0
      do k = 0, instant_count(m) - 1
         call move_to(m, closed_form(name, m%set_number, real(instant(m, k), qp)), instant(m, k), q)
         if (k == 0) q%diagnostics = redundant_by_hand(name, m)
         if (k > 0) then
            q%diagnostics = passages_by_hand(name, m, instant(m, k - 1), instant(m, k))
            tally%passed = tally%passed + count(.not. q%diagnostics%here)
            if (any(q%diagnostics%here)) then
               call stop_all_but_driven(m, q)
               flagged = flagged + 1
            end if
         end if
         call doubt_by_hand(name, m, q, doubt)
         call listing_instant(o, layout, m, one_motion(m, q, doubt), k)
      end do
      ! All of these motions are followed from their first instant on; METHOD DENSE and MATRIX cannot tell.
      if (m%method == method_newton) then
         tally%followed = instant_count(m) - 1
      else
         tally%uncertain = instant_count(m) - 1
      end if
      call listing_end(o, m, instant_count(m) - flagged, flagged, tally, &
         closure_error=merge(0.0_wp, -1.0_wp, size(redundant_by_hand(name, m)) > 0))
   end subroutine print_set

   !> Both branches have the position of `q`, each has velocities of its own, but for the links whose angle is driven.
   subroutine stop_all_but_driven(m, q)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(inout) :: q
      integer :: i

      q%known = 0
      q%mark = mark_singular
      q%singularity = singular_change
      allocate (q%link_known(size(m%links)), source=0)
      allocate (q%link_mark(size(m%links)), source=mark_singular)
      do i = 1, size(m%drives)
         if (m%drives(i)%kind /= drive_angle) cycle
         q%link_known(m%drives(i)%subject) = 2
         q%link_mark(m%drives(i)%subject) = mark_none
      end do
   end subroutine stop_all_but_driven

   !> How far the motion `q` is known, next to dead points, from the closed forms of decks whose numbers are a little
   !> off. Elsewhere no digit is in doubt.
   subroutine doubt_by_hand(name, m, q, doubt)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(error_estimate_t), intent(inout) :: doubt
      integer :: k

      if (index(name, 'dead_point') /= 1) return
      if (.not. allocated(doubt%samples)) allocate (doubt%samples(0:sample_count))
      do k = 0, sample_count
         doubt%samples(k) = q
         call move_to(m, pushed_slider(perturbed(m, k), real(perturbed_instant(q%t, k), qp)), q%t, doubt%samples(k))
      end do
      call find_estimates(m, characteristic_length(m), doubt)
      doubt%taken = .true.
      doubt%in_doubt = .true.
   end subroutine doubt_by_hand

   !> The motion `links` at `t`, its angles on the branch next to those of `q` as it comes: the instant before, at the
   !> first instant the deck's rough ones.
   subroutine move_to(m, links, t, q)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: q
      integer :: k, i

      if (size(links) /= size(m%links)) call give_up('THE CLOSED FORM AND THE DECK DIFFER IN THEIR LINKS')
      do i = 1, size(links)
         k = findloc(m%links%name == links(i)%name, .true., dim=1)
         if (k == 0) call give_up('THE DECK HAS NO LINK '//links(i)%name)
         associate (b => links(i))
            q%position(:, k) = real([b%x%v, b%y%v, next_to(real(q%position(3, k), qp), b%phi%v)], wp)
            q%velocity(:, k) = real([b%x%d, b%y%d, b%phi%d], wp)
            q%acceleration(:, k) = real([b%x%dd, b%y%dd, b%phi%dd], wp)
         end associate
      end do
      call forget_links(q)
      q%t = t
      q%known = 2
      q%mark = mark_none
   end subroutine move_to

   !> `phi` turned by whole turns until it is within half a turn of `before`.
   pure real(qp) function next_to(before, phi)
      real(qp), intent(in) :: before, phi

      next_to = phi + 2.0_qp*pi_q*anint((before - phi)/(2.0_qp*pi_q))
   end function next_to

   !> Ends the program with a sentence and the status 1.
   subroutine give_up(text)
      character(*), intent(in) :: text

      write (error_unit, '(a)') ' *** '//text
      error stop 1, quiet=.true.
   end subroutine give_up
end program print_expected
