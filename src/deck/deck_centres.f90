!> The cards POLE and CURVE of a set: instant centres, and centres of curvature of the paths of points.
module deck_centres
   use mechanism, only: request_t, request_link, request_point, request_pole, request_curve
   use independent, only: part_of_links
   use card_sets, only: card_set_t, look_up, add_card_error
   use cards, only: card_name, label_a, label_b, label_c, form_pole, form_curve
   use input_errors, only: number_range, print_repeated, centre_still, centre_apart
   use numerals, only: whole
   implicit none
   private
   public :: build_centres, check_centres

contains

   !> Adds to `set`%mechanism%requests what the POLE cards ask for, then what the CURVE cards do, both in their order.
   !> Unknown names and repeated cards are errors.
   subroutine build_centres(set)
      type(card_set_t), intent(inout) :: set
      type(request_t) :: requests(set%number_of(form_pole) + set%number_of(form_curve))
      integer :: card_of(size(requests)), form, k, i, n

      n = 0
      do form = form_pole, form_curve
         do k = 1, set%count
            if (set%cards(k)%form /= form .or. .not. set%cards(k)%valid) cycle
            n = n + 1
            card_of(n) = k
            call read_centre(set, k, requests(n))
            associate (one => requests(n), earlier => requests(:n - 1))
               i = findloc(one%subject > 0 .and. earlier%kind == one%kind .and. earlier%subject == one%subject &
                  .and. earlier%second == one%second, .true., dim=1)
            end associate
            if (i > 0) call add_card_error(set, print_repeated, k, label_a, whole(set%cards(card_of(i))%card%number))
         end do
      end do
      if (n > 0) set%mechanism%requests = [set%mechanism%requests, requests(:n)]
   end subroutine build_centres

   !> What the POLE or CURVE card `k` asks for. A name that is unknown is number 0.
   subroutine read_centre(set, k, one)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      type(request_t), intent(out) :: one

      one%every = merge(set%cards(k)%whole, 1, set%cards(k)%whole_given)
      if (one%every < 1) call add_card_error(set, number_range, k, label_c, '1 AND UP')
      if (set%cards(k)%form == form_pole) then
         one%kind = request_pole
         call look_up(set, request_link, k, label_a, one%second)
         call look_up(set, request_link, k, label_b, one%subject)
      else
         one%kind = request_curve
         call look_up(set, request_point, k, label_a, one%subject)
         call look_up(set, request_link, k, label_b, one%second)
      end if
   end subroutine read_centre

   !> Of a set without errors: each pole and curve must be of two links that move relative to one another, in one
   !> independent mechanism. A link that nothing uses is ground by now.
   subroutine check_centres(set)
      type(card_set_t), intent(inout) :: set
      type(request_t) :: one
      integer, allocatable :: part(:)
      integer :: k, link, part_i, part_j

      if (set%number_of(form_pole) + set%number_of(form_curve) == 0) return
      part = part_of_links(set%mechanism)
      do k = 1, set%count
         if (all(set%cards(k)%form /= [form_pole, form_curve])) cycle
         call read_centre(set, k, one)
         link = one%subject
         if (one%kind == request_curve) link = set%mechanism%points(link)%link
         part_j = part(link)
         part_i = 0
         if (one%second > 0) part_i = part(one%second)
         if (link == one%second .or. max(part_i, part_j) == 0) then
            call add_card_error(set, centre_still, k, card_name)
         else if (part_i /= part_j .and. min(part_i, part_j) > 0) then
            call add_card_error(set, centre_apart, k, label_b)
         end if
      end do
   end subroutine check_centres
end module deck_centres
